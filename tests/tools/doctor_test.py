#!/usr/bin/env python3
"""`tactus doctor` as a program: exit codes and JSON. Judges no time: machines differ.

usage: doctor_test.py TACTUS
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TACTUS = pathlib.Path(sys.argv.pop(1)).resolve()
SCENES = pathlib.Path(__file__).resolve().parents[2] / "config/scenes"


def doctor(*arguments):
    return subprocess.run(
        [TACTUS, "doctor", "--duration", "0.1", *arguments], capture_output=True, text=True, timeout=60
    )


class Doctor(unittest.TestCase):
    def check(self, *arguments):
        """The report; exit code, verdict and levels have to agree."""
        result = doctor("--json", *arguments)
        report = json.loads(result.stdout)
        self.assertEqual(result.returncode, 0 if report["fit"] else 3, result.stderr)
        levels = [finding["level"] for finding in report["findings"]]
        self.assertEqual(report["fit"], "not_fit" not in levels)
        for finding in report["findings"]:
            self.assertEqual("how_to_mend" in finding, finding["level"] in ("warning", "not_fit"))
        for what in ("wake_latency", "step"):
            counts = [bucket["count"] for bucket in report["loop"][f"{what}_histogram"]]
            self.assertEqual(sum(counts), report["loop"]["cycles"])
        return report

    def test_without_scene(self):
        names = [finding["name"] for finding in self.check()["findings"]]
        for name in ("kernel", "rt_throttling", "rt_group_budget", "process_rights", "service_rights",
                     "cpu_governor", "cpu_isolation", "loop_priority", "memory_lock", "cpu_latency",
                     "loop_thread", "loop_time", "disk"):  # fmt: skip
            self.assertIn(name, names)
        self.assertNotIn("can_interface", names)

    def test_with_scene(self):
        report = self.check(SCENES / "scenario1_null_space.yaml")
        buses = [f for f in report["findings"] if f["name"] == "can_interface"]
        self.assertEqual(len(buses), 4)

    def test_a_folder_that_will_be_made_is_on_a_disk_already(self):
        with tempfile.TemporaryDirectory() as folder:
            wanted = f"{folder}/logs/of/runs"
            disks = [f for f in self.check("-o", wanted)["findings"] if f["name"] == "disk"]
            self.assertEqual(len(disks), 1)
            self.assertTrue(disks[0]["what"].startswith(wanted), disks)

    def test_bad_input(self):
        result = doctor("gone.yaml")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertRegex(result.stderr, r"\Agone\.yaml:1:1: -: [^\n]+\n\Z")

    def test_usage(self):
        self.assertEqual(doctor("--duration", "never").returncode, 2)

    def test_text_ends_with_the_verdict(self):
        result = doctor()
        verdict = result.stdout.splitlines()[-1]
        self.assertTrue(verdict.startswith("fit: 0 " if result.returncode == 0 else "NOT FIT: "))


unittest.main()
