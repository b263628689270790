#!/usr/bin/python3
"""The same run in two boots: log and summary are equal to the bit, times of the kernel included.

usage: repeat_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

import sys
import unittest

from machine import Build, summary


class Repeated(unittest.TestCase):
    def test_all_files_are_equal(self):
        names = [sorted(path.relative_to(run) for path in run.rglob("*.*")) for run in runs]
        self.assertEqual(*names)
        self.assertTrue(names[0])
        for name in names[0]:
            self.assertEqual((runs[0] / name).read_bytes(), (runs[1] / name).read_bytes(), name)

    def test_there_was_something_to_differ(self):
        result = summary(runs[0] / "in_contact")
        self.assertGreater(result["peak_force_N"], 2.0)
        self.assertGreater(result["loop"]["wake_latency_ns"]["max"], 0)


if __name__ == "__main__":
    build = Build()
    runs = [build.run("repeat", folder) for folder in ["first", "second"]]
    unittest.main(argv=sys.argv[:1])
