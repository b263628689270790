#!/usr/bin/env python3
"""`tools/test` and `tools/demo`: who asks how they are used gets that and nothing else, no packages and no
build. `tools/soak`, `tools/campaign` and `tools/package`: a path is from the caller's folder.

usage: usage_test.py
"""
import os
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


class Paths(unittest.TestCase):
    """Of tools whose programs say what they are given."""

    SAYS = '#!/bin/sh\necho "${TACTUS_BUILT-$*}"\nexit 5\n'

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name in ("soak", "campaign", "package"):
            self.program(f"tools/{name}", (TOOLS / name).read_text(encoding="utf-8"))
        for name in ("tools/setup", "bin/cmake", "bin/python3", "bin/dpkg-parsechangelog"):
            self.program(name, "#!/bin/sh\n")
        for name in ("bin/dpkg-architecture", "build/release/tests/tactus_soak", "build/release/tests/tactus_campaign"):
            self.program(name, self.SAYS)
        for name in ("docs", "elsewhere"):
            (self.root / name).mkdir()

    def program(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)

    def said(self, folder, name, *arguments):
        """The first line."""
        done = subprocess.run([self.root / "tools" / name, *arguments], cwd=self.root / folder, text=True, check=False,
                              env={**os.environ, "PATH": f"{self.root}/bin:{os.environ['PATH']}"},
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertIn(done.returncode, (1, 5), done.stdout)
        return [line for line in done.stdout.splitlines() if not line.startswith("tools/package: ")][0]

    def test_are_from_where_they_are_called(self):
        for folder in ("elsewhere", "."):
            here = (self.root / folder).resolve()
            for path, meant in (("a b", f"{here}/a b"), ("/a b", "/a b")):
                with self.subTest(folder=folder, path=path):
                    self.assertEqual(self.said(folder, "soak", "--hours", "2", "-o", path, "--seed", "7"),
                                     f"--hours 2 -o {meant} --seed 7")
                    self.assertRegex(self.said(folder, "campaign", "--all", path), rf"^--all {meant} --jobs \d+$")
                    self.assertEqual(self.said(folder, "package", "--built", path), meant)

    def test_a_folder_with_other_flags_is_not_packaged(self):
        self.program("debian/rules", "#!/bin/sh\necho export CXXFLAGS=-g1\n")
        cache = self.root / "elsewhere" / "CMakeCache.txt"
        folder = str(cache.parent.resolve())
        for flags, said in (("-g1", folder),
                            ("-g1 -O0", f"{folder}: has other flags than `debian/rules flags`, begin it anew")):
            cache.write_text(f"CMAKE_CXX_FLAGS:STRING={flags}\n", encoding="utf-8")
            self.assertEqual(self.said(".", "package", "--built", folder), said)

    def test_are_the_programs_own_where_none_is_given(self):
        self.assertEqual(self.said("elsewhere", "soak"), "")
        self.assertEqual(self.said("elsewhere", "soak", "-o"), "-o")
        self.assertRegex(self.said("elsewhere", "campaign", "--all"), r"^--all build/campaign.results --jobs \d+$")
        self.assertRegex(self.said("elsewhere", "campaign", "--run", "17"), r"^--jobs \d+ --run 17$")


if __name__ == "__main__":
    unittest.main()
