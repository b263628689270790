#!/usr/bin/python3
"""The daemon whose gains are changed while the arm moves in contact, and whom others send what is no
request: no cycle is missed, and the run replays to the bit, gains included.

usage: control_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

import sys
import unittest

from machine import Build, summary


class Control(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = results / "control"
        cls.said = (cls.folder / "tactusd.txt").read_text()
        cls.loop = summary(cls.folder)["loop"]
        print(f"{cls.loop['cycles']} cycles, {cls.loop['missed_cycles']} missed")

    def test_no_cycle_is_missed(self):
        self.assertEqual(self.loop["missed_cycles"], 0)
        self.assertEqual(self.loop["page_faults"], 0)

    def test_the_arm_goes_on(self):
        self.assertEqual(summary(self.folder)["outcome"], "completed")
        self.assertNotIn("fault", self.said)

    def test_the_journal_names_the_changes(self):
        self.assertIn("tactusd: gains: change 1 ramping\n", self.said)
        self.assertIn("tactusd: gains: change 1 on_trial\n", self.said)

    def test_replays_with_its_gains(self):
        self.assertIn("to the bit", (self.folder / "replay.txt").read_text())


if __name__ == "__main__":
    build = Build()
    results = build.run("control")
    unittest.main(argv=sys.argv[:1])
