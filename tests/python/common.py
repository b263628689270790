"""What the tests of the module share. Each is called NAME_test.py FOLDER TACTUS..., where FOLDER has the
package tactus as built, and TACTUS is the program that it has to agree with."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "config/scenes"
FOLDER = pathlib.Path(sys.argv.pop(1)).resolve()
TACTUS = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(FOLDER))

import tactus  # noqa: E402

assert pathlib.Path(tactus.__file__).parent == FOLDER / "tactus", tactus.__file__

TACTILE = ("tactile_force_y_N", "tactile_force_z_N", "tactile_moment_y_Nm", "tactile_moment_z_Nm")


def program(*arguments):
    return subprocess.run([TACTUS, *map(str, arguments)], text=True, capture_output=True, timeout=300)


class Scratch(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path
