#!/usr/bin/python3
"""The daemon whose tool is told where to go, by commands and by a stream, and whom others send what is
no request: no cycle is missed, nothing that was told outlives a stop, and the run replays to the bit.

usage: told_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

import sys
import unittest

from machine import Build, summary


class Told(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = results / "told"
        cls.said = (cls.folder / "tactusd.txt").read_text()
        cls.loop = summary(cls.folder)["loop"]
        print(f"{cls.loop['cycles']} cycles, {cls.loop['missed_cycles']} missed")

    def test_no_cycle_is_missed(self):
        self.assertEqual(self.loop["missed_cycles"], 0)
        self.assertEqual(self.loop["page_faults"], 0)

    def test_the_arm_goes_on(self):
        self.assertEqual(summary(self.folder)["outcome"], "completed")
        self.assertNotIn("fault", self.said)

    def test_the_journal_names_what_became_of_orders(self):
        self.assertIn("tactusd: task: order 1 moving\n", self.said)
        self.assertIn("tactusd: task: order 1 arrived\n", self.said)
        self.assertRegex(self.said, r"tactusd: task: order \d+ late\n")
        self.assertRegex(self.said, r"tactusd: task: order \d+ stopped\n")

    def test_replays_with_what_it_was_told(self):
        self.assertIn("to the bit", (self.folder / "replay.txt").read_text())


if __name__ == "__main__":
    build = Build()
    results = build.run("told")
    unittest.main(argv=sys.argv[:1])
