#!/usr/bin/env python3
"""What docs/python.md shows runs as it stands, in its order, against a daemon in virtual time.

usage: docs_test.py FOLDER TACTUS VIRTUAL_DAEMON"""

import contextlib
import io
import os
import pathlib
import re
import shutil
import sys
import unittest

from common import ROOT, TACTUS, Scratch, program, tactus

sys.path[:0] = [str(ROOT / "tests/support"), str(ROOT / "tests/tools")]
import docs_check  # noqa: E402
from panel_rig import Rig  # noqa: E402

DAEMON = pathlib.Path(sys.argv.pop(1)).resolve()
PAGE = (ROOT / "docs/python.md").read_text()


class Page(Scratch):
    def test_runs(self):
        rig = Rig(None, DAEMON)
        self.addCleanup(rig.close)
        rig.start_daemon("simulation.obstacles=[]", pace=20)
        os.environ["RUNTIME_DIRECTORY"] = str(rig.runtime)
        self.addCleanup(os.environ.pop, "RUNTIME_DIRECTORY")
        shutil.copytree(ROOT / "config", self.folder / "config")
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        program("simulate", "config/scenes/scenario2_estimated.yaml", "-o", "runs")
        names, said, blocks = {}, io.StringIO(), 0
        for line, language, body in docs_check.fenced_blocks(PAGE):
            if language != "python":
                continue
            blocks += 1
            with self.subTest(line=line), contextlib.redirect_stdout(said):
                exec(compile("\n" * line + body, "docs/python.md", "exec"), names)  # noqa: S102
        self.assertEqual(blocks, 5)
        self.assertGreater(len(said.getvalue().splitlines()), 6)

    def test_names_what_is_there(self):
        for name in re.findall(r"`tactus\.(\w+)", PAGE):
            self.assertTrue(hasattr(tactus, name), name)
        for name in tactus.__all__:
            if isinstance(getattr(tactus, name), type) and issubclass(getattr(tactus, name), Exception):
                self.assertTrue(name == "Error" or f"`tactus.{name}`" in PAGE, name)

    def test_has_options_of_the_examples(self):
        checker = docs_check.Checker(ROOT, {"tactus": str(TACTUS), "tactusd": str(TACTUS)}, self.folder)
        docs_check.prepare(ROOT, self.folder)
        checker.check(ROOT / "docs/python.md")
        self.assertEqual(checker.found, [])


if __name__ == "__main__":
    unittest.main()
