#!/usr/bin/python3
"""`tactus calibrate` hears a module over its CAN socket: all samples, with their noise.

usage: calibrate_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

import json
import sys
import unittest

from machine import Build


def text(name):
    return (results / name).read_text()


class Calibrate(unittest.TestCase):
    def test_shows_every_sample_and_the_noise(self):
        lines = [json.loads(line) for line in text("shown.json").splitlines()]
        self.assertEqual(len(lines), 3)
        for line in lines:
            self.assertAlmostEqual(line["samples"], 250, delta=15)
            for sigma, mean in zip(line["sigma_counts"], line["mean_counts"]):
                self.assertAlmostEqual(sigma, 2000, delta=500)  # 0.02 N
                self.assertLess(abs(mean), 1000)
            self.assertLess(max(map(abs, line["wrench"])), 0.05)

    def test_records_a_zero_and_refuses_a_push_that_nobody_made(self):
        self.assertIn("refused: no channel moved", text("recorded.txt"))
        self.assertEqual(text("pushes.yaml").count("zero:"), 1)
        self.assertNotIn("force_N", text("pushes.yaml"))

    def test_says_what_is_missing(self):
        self.assertRegex(text("silent.txt"), r"can3: no sample of the frames 0x100 to 0x103 for 1 s")
        self.assertIn("can3: the interface is down", text("down.txt"))


if __name__ == "__main__":
    build = Build()
    results = build.run("calibrate")
    unittest.main(argv=sys.argv[:1])
