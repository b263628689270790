#!/usr/bin/env python3
"""Whatever is handed over, there is an exception that names what was expected, and no crash.

usage: bad_input_test.py FOLDER TACTUS"""

import copy
import inspect
import itertools
import pickle
import subprocess
import sys
import unittest

import numpy as np
from common import FOLDER, SCENES, Scratch, program, tactus

SCENE = SCENES / "scenario1_null_space.yaml"
ODD = [None, 0, -1, 3.5, "", "nonsense", b"\xff", [], {}, object(), float("nan"), np.zeros((2, 2)),
       np.array("a"), lambda: None, tactus.Scene, "a" * 100000, 1 << 80, [None], [["a"]], 1j]


class Messages(Scratch):
    def expect(self, said_by, error):
        self.assertEqual(str(error), said_by.stderr.strip())
        place, _, _ = str(error).partition(f": {error.key}: ")
        self.assertEqual(place, f"{error.file}:{error.line}:{error.column}")

    def test_are_those_of_the_commands(self):
        texts = {
            "key": f"extends: {SCENE}\ncontroller:\n  dampng: 1\n",
            "range": f"extends: {SCENE}\ncontroller: {{damping: -1}}\n",
            "type": f"extends: {SCENE}\nsimulation:\n  duration_s: [1]\n",
            "yaml": "a: [\n",
            "no robot": "task: {}\n",
            "extends": "extends: nowhere.yaml\n",
            "text": f"extends: {SCENE}\nnon\u202esense: 1\n",
        }
        for name, text in texts.items():
            path = self.file("a.yaml", text)
            with self.subTest(name), self.assertRaises(tactus.ConfigError) as refused:
                tactus.Scene(path)
            self.expect(program("simulate", path, "-o", self.folder / "runs"), refused.exception)
        self.assertFalse((self.folder / "runs").exists())

    def test_of_settings_are_those_of_the_commands(self):
        for key, value, text in (("controller.dampng", 1, "1"), ("controller.damping", -1, "-1"),
                                 ("controller.variant", "nul_space", "nul_space"), ("", 1, "1"),
                                 ("controller.damping", float("nan"), ".nan"),
                                 ("controller.damping", float("inf"), ".inf"),
                                 ("simulation.obstacles", [{"x_m": "a"}], '[{"x_m": "a"}]')):
            with self.subTest(key=key, value=value), self.assertRaises(tactus.ConfigError) as refused:
                tactus.Scene(SCENE, set={key: value})
            self.expect(program("simulate", SCENE, "-o", self.folder, "--set", f"{key}={text}"),
                        refused.exception)

    def test_of_texts_are_the_same_inside_lists_and_mappings(self):
        """Each sign reaches the loader, which says of all that they are no word it knows."""
        signs = {"\U0001f600": "\U0001f600", "é": "é", "\x7f": r"\x7f", "\x00": r"\x00", "\n": r"\x0a", '"': '"',
                 "\x85": r"\xc2\x85", "\u2028": r"\xe2\x80\xa8", "\udcff": r"\xff", "\\u": r"\u"}
        for sign, shown in signs.items():
            for values, expected in (({"task.components": [f"a{sign}"]}, f"[0]: the text 'a{shown}', expected a list"),
                                     ({"simulation.obstacles": [{f"a{sign}": 1}]}, f"[0].a{shown}: unknown key")):
                with self.subTest(sign=sign, values=values), self.assertRaises(tactus.ConfigError) as refused:
                    tactus.Scene(SCENE, set=values)
                self.assertIn(expected, str(refused.exception))
        for value in ("\ud800", ["\ud800"], [{"\ud800": 1}]):  # no sign, and no byte
            with self.assertRaisesRegex(ValueError, "surrogates not allowed"):
                tactus.Scene(SCENE, set={"task.components": value})

    def test_name_a_file_that_is_not_there(self):
        for path in (self.folder / "nix.yaml", str(self.folder / "nix.yaml"), self.folder):
            with self.assertRaisesRegex(tactus.ConfigError, "^[^:]+:1:1: -: .*, expected ") as refused:
                tactus.Scene(path)
            self.assertEqual((refused.exception.line, refused.exception.key), (1, "-"))
        with self.assertRaises(tactus.ConfigError):
            tactus.Scene(bytes(self.folder) + b"/\xff\xfe.yaml")
        with self.assertRaisesRegex(ValueError, "null"):
            tactus.Scene("a\0b.yaml")

    def test_survive_pickle(self):
        error = tactus.ConfigError("a:1:2: k: p, e", "a", 1, 2, "k")
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.file, again.column, again.key), (str(error), "a", 2, "k"))

    def test_are_of_one_kind(self):
        for error in (tactus.ConfigError, tactus.RunError, tactus.DaemonError):
            self.assertTrue(issubclass(error, tactus.Error))


class OtherPythons(unittest.TestCase):
    def test_are_told_which_one_is_expected(self):
        text = "import sys; sys.modules['tactus._core'] = None; import tactus"
        done = subprocess.run([sys.executable, "-c", text], env={"PYTHONPATH": str(FOLDER)}, text=True,
                              capture_output=True)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"ImportError: tactus is not built for .*, expected Debian's own, "
                                      r"/usr/bin/python3\n$")


class Objects(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = tactus.Scene(SCENE, set={"simulation.duration_s": 0.1})
        cls.run_ = tactus.simulate(cls.scene)

    def test_are_not_made_by_hand(self):
        core = tactus._core
        for kind in (core.Scene, core.Columns, core.Controller):
            for make in (kind, lambda: kind.__new__(kind), lambda: object.__new__(kind),
                         lambda: type("Own", (kind,), {})):
                with self.subTest(kind=kind), self.assertRaises(TypeError):
                    make()
        for kind in (tactus.Scene, tactus.Controller, tactus.Run, tactus.LogFile):
            with self.assertRaises((AttributeError, TypeError)):
                repr(kind.__new__(kind))

    def test_are_not_copied_half(self):
        for whole in (self.scene, tactus.Controller(self.scene)):
            with self.assertRaises(TypeError):
                copy.deepcopy(whole)
            with self.assertRaises(TypeError):
                pickle.dumps(whole)

    def test_refuse_odd_arguments(self):
        """Each function of one argument gets everything; what it is for is not among it."""
        controller, q = tactus.Controller(self.scene), self.scene.q_start
        functions = [tactus.Scene, tactus.simulate, tactus.read_log, tactus.replay, tactus.Controller,
                     tactus.Log, controller.update, controller.module_poses, self.run_.__getitem__,
                     lambda x: tactus.Scene(SCENE, set=x or 3),
                     lambda x: tactus.Scene(SCENE, set={"a": x}),
                     lambda x: tactus.Scene(SCENE, set={x: 1} if x.__hash__ else 3),
                     lambda x: tactus.Controller(self.scene, 0 if x is None else x),
                     lambda x: controller.update(q, 0 if x is None else x),
                     lambda x: controller.update(q, np.zeros((1, 4)), "" if x is None else x)]
        for function, odd in itertools.product(functions, ODD):
            with self.subTest(function=function, odd=type(odd)):
                with self.assertRaises((ValueError, TypeError, KeyError, OSError)) as refused:
                    function(odd)
                self.assertGreater(len(str(refused.exception)), 2)

    def test_of_the_core_refuse_odd_arguments(self):
        core, scene = tactus._core, tactus._core.load_scene(str(SCENE).encode(), [])
        controller = core.make_controller(scene, None)
        functions = [core.simulate, core.read_log, core.contacts, lambda x: core.replay(x, []),
                     lambda x: core.replay([b"nix"], x), lambda x: core.load_scene(x, []),
                     lambda x: core.load_scene(b"nix", x), lambda x: core.make_controller(x, None),
                     lambda x: core.make_controller(scene, 0 if x is None else x),
                     lambda x: controller.update(x, None, None), controller.module_poses]
        for function, odd in itertools.product(functions, ODD):
            with self.subTest(function=inspect.getsource(function) if inspect.isfunction(function)
                              else function, odd=type(odd)):
                with self.assertRaises((ValueError, TypeError, KeyError, OSError)):
                    function(odd)

    def test_refuse_by_name(self):
        controller = tactus.Controller(self.scene)
        q = self.scene.q_start
        for arguments, text in (
                ((q[:2],), r"q_measured: shape \(2,\), expected \(9,\): a position of each joint"),
                ((q * np.nan,), "q_measured: entry 0 is nan, expected finite numbers"),
                ((q + 1e300,), r"q_measured: joint j1 at 1e\+300, expected -1.2\d* to 1.2\d*"),
                ((q - np.eye(len(q))[1] * 100,), r"q_measured: joint j2 at -\d+\S*, expected "),
                ((q, np.zeros((2, 4))), r"tactile: shape \(2, 4\), expected \(1, 4\): F_y, F_z \(N\)"),
                ((q, np.zeros((1, 4)), [-1]), "sequence: entry 0 is -1, expected 0 to 4294967295")):
            with self.assertRaisesRegex(ValueError, text):
                controller.update(*arguments)
        with self.assertRaisesRegex(ValueError, "q: joint j1 at 9(.0)?, expected -0.4 to 0.4"):
            tactus.Controller(self.scene, q + 9 - q[0])
        with self.assertRaisesRegex(ValueError, r"q: joint j1 at 1e\+18, expected -1\S* to 1\S*"):
            controller.module_poses(q + 1e18)
        with self.assertRaisesRegex(RuntimeError, "expected update"):
            controller.record()
        masked = np.ma.array(q, mask=np.eye(len(q))[0])
        for arguments in ((masked,), ([np.ma.masked, *q[1:]],), (q, np.ma.masked_equal(np.zeros((1, 4)), 0.0)),
                          (q, [np.ma.masked_equal(np.zeros(4), 0.0)]),
                          (q, np.zeros((1, 4)), np.ma.masked_equal([1], 1))):
            with self.assertRaisesRegex(TypeError, r"^(q_measured|tactile|sequence): a masked entry in it, expected"):
                controller.update(*arguments)
        with self.assertRaisesRegex(TypeError, "^q: a masked entry"):
            controller.module_poses(masked)
        for value in (np.ma.masked, masked, [np.ma.masked]):
            with self.assertRaisesRegex(TypeError, "^set: task.home has a masked entry, expected a number"):
                tactus.Scene(SCENE, set={"task.home": value})
        slightly_past = np.r_[0.5, q[1:]]  # j1 goes to 0.4
        self.assertTrue(np.isfinite(tactus.Controller(self.scene).update(slightly_past)).all())
        with self.assertRaisesRegex(KeyError, "expected one of t_s, force_sensor_N"):
            self.run_["force"]
        with self.assertRaisesRegex(TypeError, "a str, expected a tactus.Scene"):
            tactus.simulate(str(SCENE))


if __name__ == "__main__":
    unittest.main()
