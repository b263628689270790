#!/usr/bin/python3
"""`tactus commission` on real CAN sockets, with an engineer who types: swapped drives, a wrong sign
and wrong counts of one joint are found and written.

usage: commission_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

import json
import re
import sys
import unittest

from machine import Build, summary


class Commission(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = results / "commission"

    def test_the_scan_names_all_nodes(self):
        scan = json.loads((self.folder / "scan.json").read_text())
        self.assertEqual(len(scan["nodes"]), 9)
        self.assertEqual(scan["missing"], [])
        self.assertTrue(all(node["is_drive"] for node in scan["nodes"]))

    def test_the_daemon_does_not_start_beside_it(self):
        self.assertIn("already runs on this interface", (self.folder / "refused.txt").read_text())

    def test_the_file_is_right(self):
        text = (self.folder / "robot.yaml").read_text()
        j2, j3 = (re.search(rf"{{.*joint: {name}, .*}}", text)[0] for name in ("j2", "j3"))
        self.assertIn("node_id: 2", j2)
        self.assertIn("node_id: 3", j3)
        self.assertIn("sign: 1", j2)
        counts = float(re.search(r"counts_per_rad: ([\d.e+]+)", j2)[1])
        self.assertAlmostEqual(counts / 1e6, 1.0, delta=0.08)
        self.assertIn("node_id: 3, sign: -1", (self.folder / "robot.yaml~").read_text())

    def test_the_daemon_moves_the_arm_with_it(self):
        moved = summary(results / "moved/free_motion")
        self.assertEqual(moved["outcome"], "completed")
        self.assertGreater(moved["loop"]["cycles"], 1900)
        self.assertEqual(moved["loop"]["missed_cycles"], 0)
        self.assertLess(moved["tcp_error_max_m"], 0.002)
        before, after = map(int, (self.folder / "moved.txt").read_text().split())
        self.assertGreater(abs(after - before), 5000)


if __name__ == "__main__":
    build = Build()
    results = build.run("commission")
    unittest.main(argv=sys.argv[:1])
