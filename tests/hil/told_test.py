#!/usr/bin/python3
"""The daemon whose tool is told where to go, by commands and by a stream, and whom others send what is
no request: no cycle is missed, nothing that was told outlives a stop, and the run replays to the bit.

usage: told_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

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


if __name__ == "__main__":
    build = Build()
    results = build.run("told")
    unittest.main(argv=sys.argv[:1])
