#!/usr/bin/env python3
"""The package is typed: mypy accepts it and those who use it as documented, refuses those who do
not, and the stub of the compiled part has the names and arguments that are there.

usage: types_test.py FOLDER TACTUS"""

import inspect
import os
import subprocess
import tempfile
import unittest

from common import FOLDER, ROOT, Scratch, tactus

USE = """
import tactus
scene = tactus.Scene("a.yaml", set={"controller.damping": 0.5, "task": None})
run: tactus.Run = tactus.simulate(scene)
peak: float = run["force_sensor_N"].max()
controller = tactus.Controller(scene)
speeds = controller.update(scene.q_start, [[0.0, 1.0, 0.0, 0.0]])
first = tactus.replay("run.ulg").first_difference
where: str = first.column if first else ""
with tactus.Daemon() as daemon:
    daemon.set({"controller.damping": 0.5}, wait=True)
"""
MISUSE = {
    "tactus.Scene(3)": "arg-type",
    "tactus.simulate('a.yaml')": "arg-type",
    "tactus.nonsense": "attr-defined",
    "tactus.Scene('a').nonsense": "attr-defined",
    "x: int = tactus.Scene('a').name": "assignment",
    "tactus.replay('a').first_difference.column": "union-attr",
    "tactus.Daemon().move(to_m='a')": "arg-type",
}


def mypy(*arguments):
    return subprocess.run(["/usr/bin/python3", "-m", *arguments], text=True, capture_output=True,
                          env=os.environ | {"MYPYPATH": str(FOLDER), "PYTHONPATH": str(FOLDER)})


class Types(Scratch):
    @classmethod
    def setUpClass(cls):  # what is known of NumPy takes the most time
        cls.cache = cls.enterClassContext(tempfile.TemporaryDirectory())

    def check(self, text):
        return mypy("mypy", "--strict", "--cache-dir", self.cache, self.file("use.py", text))

    def test_of_the_package_are_right(self):
        done = mypy("mypy", "--strict", "--ignore-missing-imports", "--cache-dir", self.cache,
                    FOLDER / "tactus")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue((FOLDER / "tactus/py.typed").is_file())

    def test_accept_use_and_refuse_misuse(self):
        done = self.check(USE)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        done = self.check("import tactus\n" + "\n".join(MISUSE))
        found = {line.split(":")[1]: line for line in done.stdout.splitlines() if ": error:" in line}
        for number, (text, kind) in enumerate(MISUSE.items(), 2):
            self.assertIn(f"[{kind}]", found.get(str(number), "nothing"), text)

    def test_of_the_stub_are_those_of_the_compiled_part(self):
        # Of pybind11's classes their metaclass, and that nobody may make them.
        allowed = self.file("allowed.txt", r"tactus\._core\.(Columns|Controller|Scene|StudyScene)(\.__init__)?")
        done = mypy("mypy.stubtest", "tactus._core", "--allowlist", allowed)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        names = {name for name in vars(tactus._core) if not name.startswith("__")}
        text = (ROOT / "src/python/tactus/_core.pyi").read_text()
        for name in names:
            self.assertRegex(text, rf"(?m)^(class {name}:|def {name}\(|{name}: )")
        for kind in (tactus._core.Scene, tactus._core.Columns, tactus._core.Controller):
            for name in (name for name in vars(kind) if not name.startswith("_")):
                self.assertRegex(text, rf"    def {name}\(")


class Documentation(unittest.TestCase):
    def test_is_there_for_all_that_is_public(self):
        for name in tactus.__all__:
            thing = getattr(tactus, name)
            if inspect.isclass(thing) or inspect.isfunction(thing):
                self.assertTrue(inspect.getdoc(thing), name)
            for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    self.assertTrue(value.__doc__, f"{name}.{member}")
        self.assertEqual(sorted(tactus.__all__), tactus.__all__ and sorted(set(tactus.__all__)))


if __name__ == "__main__":
    unittest.main()
