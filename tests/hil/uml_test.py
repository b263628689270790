#!/usr/bin/env python3
"""The runner for User Mode Linux: what a script does in there comes out, and nothing else does.

usage: uml_test.py
"""
import os
import pathlib
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent


class Runner(unittest.TestCase):
    def setUp(self):
        build = HERE.parents[1] / "build/hil"
        build.mkdir(parents=True, exist_ok=True)
        folder = tempfile.TemporaryDirectory(prefix="with space ", dir=build)
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.folder.chmod(0o755)
        self.out = self.folder / "out"

    def run_script(self, text, *arguments, timeout_s=60):
        script = self.folder / "a script"
        script.write_text(f"#!/bin/sh\n{text}")
        script.chmod(0o755)
        command = [HERE / "uml", script, "--out", self.out, "--timeout", str(timeout_s)]
        return subprocess.run(
            [*command, "--", *arguments], capture_output=True, text=True, timeout=400
        )

    def test_script_finds_what_it_needs(self):
        victim = self.folder / "victim"
        victim.write_text("mine")
        result = self.run_script(
            'for i in 0 1 2 3; do ip link show "can$i" | grep -q UP || exit 1; done\n'
            'test "$PWD" = "$1" || exit 2\n'
            'test "$2" = "it\'s one" || exit 3\n'
            'mount -o remount,rw /; echo lost >"$3"\n'
            'echo kept >"$RESULTS/a result"\n'
            "candump -n 1 -T 5000 can2 & sleep 0.5; cansend can2 123#11; wait\n"
            "exit 42\n",
            HERE.parents[1],
            "it's one",
            victim,
        )
        self.assertEqual(result.returncode, 42, result)
        self.assertIn("123   [1]  11", result.stdout)
        self.assertEqual((self.out / "a result").read_text(), "kept\n")
        # As an ordinary user the files are as safe as that user's rights make them.
        if os.getuid() == 0:
            self.assertEqual(victim.read_text(), "mine")

    def test_endless_script_is_ended(self):
        result = self.run_script("echo begun; trap '' TERM; while :; do sleep 1; done", timeout_s=1)
        self.assertIn(result.returncode, (124, 137), result)
        self.assertIn("begun", result.stdout)

    def test_run_without_status_is_no_success(self):
        self.out.mkdir()
        (self.out / "status").write_text("0")  # of an older run
        result = self.run_script("echo o >/proc/sysrq-trigger; sleep 60")
        self.assertEqual(result.returncode, 125, result)
        self.assertIn("did not end", result.stderr)


if __name__ == "__main__":
    unittest.main()
