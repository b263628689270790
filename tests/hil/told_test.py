#!/usr/bin/python3
"""The daemon whose tool is told where to go, by commands and by a stream, and whom others send what is
no request: no cycle is missed, nothing that was told outlives a stop, and the run replays to the bit.

usage: told_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

import json
import sys
import unittest

from asked_run import AskedRun
from machine import Build


class Told(AskedRun, unittest.TestCase):
    @classmethod
    def folder_of_results(cls):
        return results / "told"

    def test_the_journal_names_what_became_of_orders(self):
        self.assertIn("tactusd: task: order 1 moving\n", self.said)
        self.assertIn("tactusd: task: order 1 arrived\n", self.said)
        self.assertRegex(self.said, r"tactusd: task: order \d+ late\n")
        self.assertRegex(self.said, r"tactusd: task: order \d+ stopped\n")

    def test_another_daemon_begins_where_the_arm_was_left(self):
        again = (self.folder / "again.txt").read_text()
        self.assertRegex(again, r"tactusd: the arm is at start: \[.*\]\n")
        self.assertIn("tactusd: task: order 1 arrived\n", again)
        self.assertNotIn("fault", again)
        self.assertIn("to the bit", (self.folder / "again_replay.txt").read_text())
        start = json.loads("[" + again.split("start: [")[1].split("]")[0] + "]")
        where = json.loads((self.folder / "where.json").read_text())
        for position, joint in zip(start, where["joints"], strict=True):
            self.assertAlmostEqual(position, joint["position"], places=6)
        self.assertTrue(any(abs(joint["position"] - joint["start"]) > where["start_tolerance"]
                            for joint in where["joints"]))

    def test_an_arm_is_brought_back_to_where_scenes_begin(self):
        home = (self.folder / "home.txt").read_text()
        self.assertNotIn("fault", home)
        self.assertIn("to the bit", (self.folder / "home_replay.txt").read_text())
        self.assertIn("tactusd: running", (self.folder / "begins.txt").read_text())


if __name__ == "__main__":
    build = Build()
    results = build.run("told")
    unittest.main(argv=sys.argv[:1])
