#!/usr/bin/python3
"""`tactus doctor` on a PREEMPT_RT kernel with CAN interfaces and a GPIO chip: finds what is there, and
what was taken away.

usage: doctor_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

import json
import sys
import unittest

from machine import Build


def examined(name):
    """Exit status, levels by name, and the whole report."""
    report = json.loads((results / f"{name}.json").read_text())
    levels = {}
    for finding in report["findings"]:
        levels.setdefault(finding["name"], []).append(finding["level"])
    return int((results / f"{name}.status").read_text()), levels, report


class Doctor(unittest.TestCase):
    def test_machine_in_order_is_fit(self):
        status, levels, report = examined("in_order")
        self.assertEqual((status, report["fit"]), (0, True), report["findings"])
        for name in ["kernel", "memory_lock", "cpu_latency", "loop_thread", "loop_time", "gpio",
                     "rt_group_budget", "process_rights"]:  # fmt: skip
            self.assertEqual(levels[name], ["ok"], name)
        self.assertEqual(levels["can_interface"], ["ok"] * 4)
        self.assertEqual(levels["can_queue"], ["ok"] * 4)
        self.assertEqual(levels["can_adapter"], ["note"] * 4, "virtual")
        self.assertEqual(levels["cpu_isolation"], ["warning"])
        self.assertEqual(report["loop"]["cycles"], 2000)
        self.assertEqual(report["loop"]["missed_cycles"], 0)

    def test_what_was_taken_away_is_found(self):
        status, levels, report = examined("not_in_order")
        self.assertEqual((status, report["fit"]), (3, False))
        self.assertEqual(sorted(levels["can_interface"]), ["not_fit", "ok", "ok", "ok"])
        self.assertEqual(sorted(levels["can_queue"]), ["ok", "ok", "ok", "warning"])
        self.assertEqual(levels["gpio"], ["not_fit"])


if __name__ == "__main__":
    build = Build()
    results = build.run("doctor")
    unittest.main(argv=sys.argv[:1])
