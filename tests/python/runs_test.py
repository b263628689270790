#!/usr/bin/env python3
"""Runs, logs, checks and replays are those of the programs, to the bit.

usage: runs_test.py FOLDER TACTUS"""

import gc
import json
import os
import pathlib
import struct
import sys
import unittest
import unittest.mock
import warnings

import numpy as np
from common import SCENES, Scratch, program, tactus

RUNS = ("free_motion", "scenario1_joint_space", "scenario1_multi_space", "scenario3_tactus",
        "robots/planar2_contact", "real/real_scenario3_mx", "whole_arm/crops9_skin_two_links",
        "whole_arm/planar3_clutter")
WITH_CLOCK = {"step_ns"}  # what two runs do not have in common
SHORT = {"simulation.duration_s": 4}


def scene_file(name):
    return SCENES / f"{name}.yaml"


def bits(array):
    return array.view(np.uint64)


class Simulations(Scratch):
    def test_have_the_bits_of_the_programs_log(self):
        done = program("simulate", *map(scene_file, RUNS), "-o", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in RUNS:
            with self.subTest(scene=name):
                self.compare(name)

    def compare(self, name):
        run = tactus.simulate(tactus.Scene(scene_file(name)))
        folder = self.folder / scene_file(name).stem
        log = tactus.read_log(folder / "run.ulg")
        self.assertFalse(log.is_cut_off)
        self.assertEqual(list(run), list(log))
        self.assertGreater(run.cycles, 1000)
        for field in set(run) - WITH_CLOCK:
            self.assertEqual(run[field].shape, log[field].shape, field)
            self.assertTrue((bits(run[field]) == bits(log[field])).all(), field)
        summary = json.loads((folder / "summary.json").read_text())
        for figures in (summary, run.summary):
            del figures["step_time_ns"], figures["real_time_factor"]
        self.assertEqual(run.summary, summary)
        self.assertEqual(log.contacts, json.loads(program("contacts", log.path, "--json").stdout))

    def test_say_where_a_log_does_not_begin_with_its_run(self):
        program("simulate", scene_file("scenario2_estimated"), "-o", self.folder, "--set", "simulation.duration_s=4")
        path = self.folder / "scenario2_estimated/run.ulg"
        whole = path.read_bytes()
        first = 16 + 3 + int.from_bytes(whole[16:18], "little")  # behind the header and the flags
        for part, begin in ((b"0", None), (b"2", "begins at 0.000 s of the run: "), (b"x", None)):
            key = b"char[1] part"
            info = struct.pack("<HcB", 1 + len(key) + len(part), b"I", len(key)) + key + part
            path.write_bytes(whole[:first] + info + whole[first:])
            if part == b"x":
                with self.assertRaisesRegex(tactus.ConfigError, ": part: 'x' is not a part's number"):
                    tactus.read_log(path)
                continue
            log = tactus.read_log(path)
            self.assertEqual(log.part, int(part))
            with warnings.catch_warnings(record=True) as seen:
                warnings.simplefilter("always")
                contacts = log.contacts
            done = program("contacts", path, "--json")
            self.assertEqual(contacts, json.loads(done.stdout))
            self.assertEqual([f"{one.message}\n" for one in seen], [done.stderr] if begin else [])
            self.assertEqual([one.filename for one in seen], [__file__] if begin else [])
            self.assertIn(begin or "", done.stderr)
        path.write_bytes(whole)
        self.assertEqual(tactus.read_log(path).part, 0)

    def test_have_the_columns_of_the_csv(self):
        for name in ("scenario2_estimated", "whole_arm/crops9_skin_two_links"):
            with self.subTest(scene=name):
                log, csv = self.folder / scene_file(name).stem / "run.ulg", self.folder / "run.csv"
                program("simulate", scene_file(name), "-o", self.folder, "--set",
                        "simulation.duration_s=4")
                self.assertEqual(program("export", log, "-o", csv).returncode, 0)
                columns = tactus.read_log(log).columns()
                lines = csv.read_text().splitlines()
                header = lines[0].split(",")
                self.assertEqual(header, [*columns, "fault_name", "mode_name"])
                rows = [line.split(",")[:-2] for line in lines[1:]]
                for name, texts in zip(header, zip(*rows)):
                    of_type = columns[name].dtype.type
                    self.assertEqual(list(columns[name]), list(map(of_type, texts)), name)

    def test_take_settings(self):
        settings = {"controller.time_constant_s": 0.2, "controller.damping": 1, "stiffness": None,
                    "stiffness.assumed_N_per_m": np.float32(5000), "controller.variant": "null_space",
                    "simulation.obstacles": [{"x_m": 0.7, "y_m": 0.01, "stiffness_N_per_m": 900}],
                    "simulation.duration_s": 7}
        on_line = ["controller.time_constant_s=0.2", "controller.damping=1", "stiffness=null",
                   "stiffness.assumed_N_per_m=5000", "controller.variant=null_space",
                   "simulation.obstacles=[{x_m: 0.7, y_m: 0.01, stiffness_N_per_m: 900}]",
                   "simulation.duration_s=7"]
        name = "scenario1_multi_space"
        done = program("simulate", scene_file(name), "-o", self.folder,
                       *(word for setting in on_line for word in ("--set", setting)))
        self.assertEqual(done.returncode, 0, done.stderr)
        run = tactus.simulate(tactus.Scene(scene_file(name), set=settings))
        log = tactus.read_log(self.folder / name / "run.ulg")
        self.assertTrue((bits(run["dq"]) == bits(log["dq"])).all())
        self.assertGreater(run["force_sensor_N"].max(), 1)

    def test_end_with_the_fault_of_the_program(self):
        limit = {"robot.tactile_modules[0].max_force_N": 4}
        run = tactus.simulate(tactus.Scene(scene_file("scenario1_null_space"), set=limit))
        done = program("simulate", scene_file("scenario1_null_space"), "-o", self.folder, "--set",
                       "robot.tactile_modules[0].max_force_N=4", "--json")
        self.assertEqual(done.returncode, 3)
        self.assertEqual(run.fault, json.loads(done.stdout)[0]["fault"]["name"])
        log = tactus.read_log(self.folder / "scenario1_null_space/run.ulg")
        self.assertEqual(run.cycles, log.cycles)
        self.assertIn("retreating", {tactus.MODES[mode] for mode in run["mode"]})


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = tactus.Scene(scene_file("whole_arm/crops9_skin_two_links"), set=SHORT)
        cls.run_ = tactus.simulate(cls.scene)

    def test_have_the_shapes_that_are_documented(self):
        run, joints = self.run_, len(self.scene.joints)
        self.assertEqual(run.cycles, 4000)
        for field in run:
            shape = {"q": (joints,), "dq": (joints,), "q_measured": (joints,), "w": (3,), "wd": (3,),
                     "wd_dot": (3,)}.get(field, ())
            if field.startswith(("force_sensor", "contact_", "tactile_")):
                shape = (3,)
            self.assertEqual(run[field].shape, (4000, *shape), field)
            self.assertIn(run[field].dtype, (np.float64, np.int64, np.uint64), field)

    def test_are_views_that_keep_the_memory_and_cannot_be_written(self):
        run = tactus.simulate(self.scene)
        array = run["q"]
        self.assertTrue(np.shares_memory(array, run["q"]))
        self.assertTrue(np.shares_memory(array, run.columns()["q_2"]))
        with self.assertRaises(ValueError):
            array[0, 0] = 1
        with self.assertRaises(ValueError):
            array.flags.writeable = True
        del run
        gc.collect()
        junk = [np.full(array.shape, 7.0) for _ in range(20)]
        self.assertTrue((bits(array) == bits(self.run_["q"])).all(), len(junk))

    def test_are_those_of_pandas(self):
        frame = self.run_.to_pandas()
        self.assertEqual(frame.index.name, "t_s")
        self.assertTrue((frame["q_3"].to_numpy() == self.run_["q"][:, 2]).all())
        self.assertEqual(set(frame["fault_name"]), {"none"})
        self.assertEqual(set(frame["mode_name"]), {"running"})
        self.assertEqual([*frame.reset_index()],
                         [*self.run_.columns(), "fault_name", "mode_name"])

    def test_need_pandas_only_there(self):
        with unittest.mock.patch.dict(sys.modules, {"pandas": None}):
            with self.assertRaisesRegex(ModuleNotFoundError, "pandas"):
                self.run_.to_pandas()


class Checks(unittest.TestCase):
    def test_say_what_the_program_says(self):
        for name in (*RUNS, "scenario2_tactus", "commands"):
            with self.subTest(scene=name):
                said = json.loads(program("check", scene_file(name), "--json").stdout)
                self.assertEqual(tactus.Scene(scene_file(name)).check(), said)

    def test_refuse_what_the_program_refuses(self):
        set_, text = {"controller.time_constant_s": 0.02}, "controller.time_constant_s=0.02"
        scene = tactus.Scene(scene_file("scenario3_estimated"), set=set_)  # simulations may be unstable
        with self.assertRaises(tactus.ConfigError) as refused:
            scene.check()
        done = program("check", scene_file("scenario3_estimated"), "--set", text)
        self.assertEqual((done.returncode, done.stderr.strip()), (1, str(refused.exception)))

    def test_of_gains_are_those_of_the_file(self):
        scene = tactus.Scene(scene_file("scenario1_multi_space"), set={"controller.damping": 0.75})
        self.assertEqual(scene.gains["controller.time_constant_s"], 0.1)
        self.assertEqual(scene.gains["controller.damping"], 0.75)
        self.assertEqual(scene.gains["controller.activation_force_N"], 3.8)


class Replays(Scratch):
    def setUp(self):
        super().setUp()
        program("simulate", scene_file("scenario2_estimated"), "-o", self.folder, "--set",
                "simulation.duration_s=4")
        self.log = self.folder / "scenario2_estimated/run.ulg"

    def test_are_equal_to_the_bit(self):
        replay = tactus.replay(self.log)
        self.assertTrue(replay.is_equal)
        self.assertEqual((replay.cycles, replay.compared_cycles), (4000, 4000))
        self.assertEqual((replay.first_difference, replay.largest_differences), (None, []))
        self.assertEqual((replay.is_cut_off, replay.not_replayed), (False, []))
        self.log.write_bytes(self.log.read_bytes()[:-1000])
        self.assertTrue(tactus.replay(self.log).is_cut_off)

    def test_name_the_first_difference(self):
        """One bit of one logged command is turned over."""
        q = tactus.read_log(self.log)["dq"]
        cycle, joint = 1234, 3
        content = self.log.read_bytes()
        row = q[cycle].tobytes()
        self.assertEqual(content.count(row), 1)
        at = content.index(row) + 8 * joint
        self.log.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1:])
        replay = tactus.replay(self.log)
        first = replay.first_difference
        self.assertEqual((replay.differing_cycles, first.cycle, first.column, first.replayed),
                         (1, cycle, "dq_4", q[cycle, joint]))
        bits_ = [struct.unpack("<Q", struct.pack("<d", x))[0] for x in (first.recorded, first.replayed)]
        self.assertEqual(bits_[0] ^ bits_[1], 1)

    def test_take_settings_as_the_program_does(self):
        replay = tactus.replay([self.log], set={"controller.damping": 0.7})
        done = program("replay", self.log, "--set", "controller.damping=0.7", "--json")
        said = json.loads(done.stdout)
        self.assertFalse(replay.is_equal)
        self.assertEqual(vars(replay.first_difference), said["first_difference"])
        self.assertEqual([vars(one) for one in replay.largest_differences], said["largest_differences"])
        for logs in ((self.log,), iter([self.log]), os.fsencode(self.log)):
            self.assertEqual(tactus.replay(logs, set={"controller.damping": 0.7}), replay)


class Logs(Scratch):
    def setUp(self):
        super().setUp()
        program("simulate", scene_file("scenario2_estimated"), "-o", self.folder, "--set",
                "simulation.duration_s=1")
        self.log = self.folder / "scenario2_estimated/run.ulg"

    def test_that_were_cut_off_are_read_up_to_there(self):
        whole, content = tactus.read_log(self.log), self.log.read_bytes()
        self.log.write_bytes(content[:-1000])
        cut = tactus.read_log(self.log)
        self.assertTrue(cut.is_cut_off)
        self.assertTrue(900 < cut.cycles < whole.cycles, cut.cycles)
        self.assertTrue((cut["q"] == whole["q"][: cut.cycles]).all())

    def test_that_are_damaged_are_refused_as_by_the_program(self):
        content = self.log.read_bytes()
        for end in (0, 10, 1000):
            self.log.write_bytes(content[:end])
            with self.subTest(end=end), self.assertRaises(tactus.ConfigError) as refused:
                tactus.read_log(self.log)
            said = program("export", self.log, "-o", self.folder / "a.csv").stderr.strip()
            self.assertEqual(str(refused.exception), said)

    def test_have_contacts_of_the_file_that_was_read(self):
        """Not of one that has its name later, be it by another folder or another run."""
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.log.parent)
        whole = self.log.read_bytes()
        self.log.write_bytes(whole[:len(whole) // 2])  # of a run that goes on
        logs = [tactus.read_log("run.ulg") for _ in range(2)]
        os.chdir(before)
        self.log.write_bytes(whole)
        self.assertEqual(logs[0].contacts, json.loads(program("contacts", self.log, "--json").stdout))
        for duration_s, time_constant_s in ((1, 0.3), (0.1, 0.1)):
            program("simulate", scene_file("scenario2_estimated"), "-o", self.folder, "--set",
                    f"simulation.duration_s={duration_s}", "--set", f"controller.time_constant_s={time_constant_s}")
            with self.assertRaisesRegex(tactus.ConfigError, "^run.ulg:1:1: -: another file than was read, expected"):
                logs[1].contacts
        self.log.unlink()
        with self.assertRaisesRegex(tactus.ConfigError, "No such file"):
            logs[1].contacts

    def test_name_their_scene(self):
        log, scene = tactus.read_log(self.log), tactus.Scene(scene_file("scenario2_estimated"))
        self.assertEqual(log.parameters["controller/damping"], 0.5)
        self.assertIn("scenario2_estimated", json.dumps(log.infos))
        self.assertEqual(set(log.units), set(log))
        self.assertEqual(log.units["force_sensor_N"], "N")
        self.assertEqual((log.joints, log.modules), (scene.joints, scene.modules))
        self.assertEqual(log.overrides, {"simulation.duration_s": "1"})

    def test_have_the_files_that_they_were_made_of(self):
        sources = tactus.read_log(self.log).sources
        files = tactus.Scene(scene_file("scenario2_estimated")).files
        self.assertEqual([path.rpartition("/")[2] for path in sources],
                         [path.rpartition("/")[2] for path in files])
        for path, (_, text) in zip(files, sources.items()):
            self.assertEqual(text, pathlib.Path(path).read_text(encoding="utf-8"), path)

    def test_keep_the_bytes_of_texts_that_are_no_utf_8(self):
        content = self.log.read_bytes()
        self.log.write_bytes(content.replace(b"tip: tcp", b"tip: \xfc\xfe\xff"))
        self.assertIn("tip: \udcfc\udcfe\udcff", "".join(tactus.read_log(self.log).sources.values()))


if __name__ == "__main__":
    unittest.main()
