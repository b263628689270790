#!/usr/bin/env python3
"""`tools/test` and `tools/demo`: who asks how they are used gets that and nothing else, no packages and no
build.

usage: usage_test.py
"""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"


class Usage(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.tools = pathlib.Path(self.folder.name) / "tools"
        self.tools.mkdir()
        setup = self.tools / "setup"
        setup.write_text("#!/bin/sh\necho installs >&2\nexit 7\n")
        setup.chmod(0o755)

    def run_tool(self, name, *arguments):
        shutil.copy(TOOLS / name, self.tools)
        return subprocess.run([self.tools / name, *arguments], capture_output=True, text=True, check=False)

    def test_is_all_that_is_done(self):
        for name in ("test", "demo"):
            for option in ("-h", "--help"):
                with self.subTest(name=name, option=option):
                    done = self.run_tool(name, option)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertRegex(done.stdout, rf"^usage: tools/{name} \[.*\]    .*\n$")

    def test_is_told_of_what_there_is_not(self):
        for arguments in (["--nonsense"], ["folder"], ["-o"]):
            with self.subTest(arguments=arguments):
                done = self.run_tool("demo", *arguments)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertIn("usage: tools/demo [-o DIR]", done.stderr)
                self.assertNotIn("installs", done.stderr)

    def test_is_not_what_a_run_begins_with(self):
        """Else the tests above could not fail."""
        for name in ("test", "demo"):
            done = self.run_tool(name)
            self.assertEqual((done.returncode, done.stderr), (7, "installs\n"), name)


if __name__ == "__main__":
    unittest.main()
