#!/usr/bin/env python3
"""`tactus sweep`: what a study leaves, whoever computes it, and what it says of studies that are wrong.

usage: sweep_test.py FOLDER TACTUS"""

import html
import itertools
import json
import math
import pathlib
import random
import re
import shlex
import shutil
import subprocess
import tempfile
import types
import unittest
from unittest import mock

import numpy as np
from common import ROOT, SCENES, TACTUS, Scratch, program, tactus
from scipy import stats
from sweep_common import RUNS, SCENE, Sweeps, rows_of, runs_in, table_of
from tactus import _sweep
from tactus._sweep import run

from tactus_sweep import check, judge, pool, progress, scenes, study, study_page


class Results(Sweeps):
    def test_are_the_same_bytes_for_any_number_of_workers(self):
        one, three = self.whole("one", "-j", 1), self.whole("three", "-j", 3)
        self.assertEqual(table_of(one), table_of(three))
        self.assertEqual((one / "report.html").read_bytes(), (three / "report.html").read_bytes())
        self.assertEqual([int(row["run"]) for row in rows_of(one)], list(range(RUNS)))
        self.assertEqual(sorted(runs_in(three)), list(range(RUNS)))
        self.expect_all_kinds(rows_of(one))
        self.expect_front(one)
        self.expect_reruns(one)

    def test_name_what_was_chosen_and_not_what_disturbed(self):
        drawn = "disturbances: {draws: 3, keys: {simulation.tactile_module.noise_N: {from: 0, to: 0.05}}}"
        other = SCENE.parent / "ur5e_contact.yaml"
        for number, (scenes_, grid, named) in enumerate((
                ([SCENE], "[0.5, 0.7]", r"controller\.damping=0\.[57]"),
                ([SCENE], "[0.5]", r"controller\.damping=0\.5, simulation\.tactile_module\.noise_N=\S+"),
                ([SCENE, other], "[0.5]", r"\S+_contact\.yaml, controller\.damping=0\.5, simulation\S+noise_N=\S+"))):
            text = (f"scenes: {json.dumps([str(scene) for scene in scenes_])}\nset: {{simulation.duration_s: 1}}\n"
                    f"grid: {{controller.damping: {grid}}}\n{drawn}\n")
            done = self.sweep(self.study(text), self.folder / f"out{number}")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, rf"(?m)^best: {named}$")
            page = html.unescape((self.folder / f"out{number}/report.html").read_text())
            part = page[page.index('<table class="best">'):]
            names = re.findall(r'<th scope="row">(.*?)</th>', part[:part.index("</table>")])
            self.assertEqual(len(set(names)), len(names), names)

    def expect_all_kinds(self, rows):
        outcomes = {row["outcome"] for row in rows}
        self.assertIn("refused", outcomes)
        self.assertIn("completed", outcomes)
        self.assertEqual(len(outcomes), 3, outcomes)  # and a fault
        for row in rows:
            early = float(row["simulation.obstacles[0].vanishes_s"]) < float(
                row["simulation.obstacles[0].appears_s"])
            self.assertEqual(row["outcome"] == "refused", early)
            self.assertEqual(row["reason"] == "", row["outcome"] == "completed")
            if row["outcome"] == "refused":
                self.assertIn("vanishes_s: 3.6 s is too early, expected more than appears_s = 4", row["reason"])
            if row["outcome"] == "completed":
                is_within = float(row["peak_force_N"]) <= 1.38
                self.assertEqual((row["is_within"], row["objective"]),
                                 (str(int(is_within)), row["peak_force_N"]))

    def expect_front(self, folder):
        """By comparing each with each."""
        groups = {}
        for row in rows_of(folder):
            key = tuple(row[key] for key in ("simulation.obstacles[0].appears_s", "controller.damping",
                                             "simulation.obstacles[0].vanishes_s"))
            known = [float(row[name] or "inf") if row["outcome"] == "completed" else math.inf
                     for name in ("peak_force_N", "tcp_error_max_m")]
            groups.setdefault(key, []).append(known)
        worst = {key: tuple(map(max, zip(*values))) for key, values in groups.items()}
        front = {key for key, (force, error) in worst.items() if math.isfinite(force) and not any(
            f <= force and e <= error and (f, e) != (force, error) for f, e in worst.values())}
        page = (folder / "report.html").read_text()
        part = page[page.index('<table class="front">'):]
        names = re.findall(r'<th scope="row">(.*?)</th>', part[:part.index("</table>")])
        shown = {tuple(dict(setting.split("=") for setting in html.unescape(name).split(", "))[key]
                       for key in ("simulation.obstacles[0].appears_s", "controller.damping",
                                   "simulation.obstacles[0].vanishes_s")) for name in names}
        self.assertEqual(shown, front)

    def expect_reruns(self, folder):
        """The line of the worst run gives its figures."""
        page = html.unescape((folder / "report.html").read_text()).replace("\xa0", " ")
        part = page[page.index('<table class="worst">'):]
        run = re.search(r'<th scope="row">(\d+)</th>', part)[1]
        words = shlex.split(re.search(r"tactus simulate [^<]*", part)[0])
        done = subprocess.run([TACTUS, *words[1:]], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads((self.folder / f"runs/study/run_{run}/summary.json").read_text())
        row = rows_of(folder)[int(run)]
        for name in ("peak_force_N", "tcp_error_max_m", "tcp_error_rms_m"):
            self.assertEqual(float(row[name]), summary[name])

    def test_of_a_worker_that_dies_are_a_row(self):
        """Each worker that meets a trap in its tactus ends as if it had crashed."""
        trap = self.file("sitecustomize.py", """
import os, sys
if "-m" in sys.orig_argv and "tactus._sweep" in sys.orig_argv:
    import tactus._core
    figures = tactus._core.figures
    def trapped(scene):
        if scene.numbers()["controller.damping"] == 0.625:
            os._exit(7)
        return figures(scene)
    tactus._core.figures = trapped
""")
        study = self.study(f"scenes: [{SCENE}]\nset: {{simulation.duration_s: 0.1}}\n"
                           "grid: {controller.damping: [0.5, 0.625, 0.75, 1]}\n")
        folder = self.folder / "trapped"
        done = self.sweep(study, folder, "-j", 2, env={"PYTHONPATH": str(trap.parent), "PATH": "/usr/bin"})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual([row["outcome"] for row in rows_of(folder)],
                         ["completed", "failed", "completed", "completed"])
        self.assertEqual(rows_of(folder)[1]["reason"], "its worker ended with 7, 2 times")

    def test_of_workers_that_cannot_start_are_left_to_the_others(self):
        """All but the first, which is at work then, find no memory, say: they are not started for ever."""
        started = self.folder / "started"
        trap = self.file("sitecustomize.py", f"""
import os, sys, time
if "-m" in sys.orig_argv and "tactus._sweep" in sys.orig_argv:
    started = os.open({str(started)!r}, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    worked = os.open({str(started)!r} + ".worked", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.write(started, b".")
    try:
        os.close(os.open({str(started)!r} + ".first", os.O_WRONLY | os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        while os.fstat(worked).st_size < 50:
            time.sleep(0.01)
        os._exit(7)
    import tactus._core
    figures = tactus._core.figures
    def counted(scene):
        os.write(worked, b".")
        return figures(scene)
    tactus._core.figures = counted
""")
        study = self.study(f"scenes: [{SCENE}]\nset: {{simulation.duration_s: 2}}\n"
                           "grid: {controller.damping: {from: 0.5, to: 1, count: 32}}\n"
                           "sobol: {points: 64, keys: {controller.time_constant_s: {from: 0.1, to: 0.2}}}\n")
        folder = self.folder / "stillborn"
        done = self.sweep(study, folder, "-j", 2, env={"PYTHONPATH": str(trap.parent), "PATH": "/usr/bin"})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([row["outcome"] for row in rows_of(folder)], 2048 * ["completed"])
        self.assertEqual(started.stat().st_size, 3)

    def test_as_json(self):
        study = self.study(f"scenes: [{SCENE}]\nset: {{simulation.duration_s: 0.1}}\n"
                           "sobol: {points: 4, keys: {controller.damping: {from: 0.5, to: 1}}}\n")
        answer = json.loads(self.sweep(study, self.folder / "out", "--json").stdout)
        self.assertEqual((answer["done"], answer["runs"], answer["run_now"], answer["completed"]),
                         (True, 4, 4, 4))
        answer = json.loads(self.sweep(study, self.folder / "out", "--json").stdout)
        self.assertEqual((answer["runs"], answer["run_now"]), (4, 0))


class Scenes(unittest.TestCase):
    """Of files that are parsed once."""

    SETTINGS = ({}, {"controller.damping": "0.9"}, {"controller.nonsense": "1"},
                {"robot.tactile_modules[0].max_force_N": "50", "simulation.drive_lag_s": "0.01"},
                {"robot.nonsense": "1"}, {"simulation.obstacles[0].x_m": "0.7", "task.drift_gain_per_s": "2"},
                {"controller.variant": "none"}, {"controller.damping": "-1"}, {"simulation.duration_s": "3"})

    def test_are_those_of_loading_whatever_was_loaded_before(self):
        chance = random.Random(7)
        for name in ("scenario1_tactus", "whole_arm/crops9_skin_two_links", "robots/planar2_contact"):
            path = SCENES / f"{name}.yaml"
            files = tactus.Scene(path)._core.sources()
            parsed = tactus._core.study_scene(files)
            for settings in chance.choices(self.SETTINGS, k=30):
                texts = [f"{key}={value}".encode() for key, value in settings.items()]
                with self.subTest(scene=name, settings=settings):
                    self.assertEqual(self.outcome(lambda: parsed.load(texts)),
                                     self.outcome(lambda: tactus.Scene(path, set=settings)._core))

    def outcome(self, load):
        try:
            scene = load()
            return scene.numbers(), scene.gains(), scene.files(), scene.sources()
        except tactus.ConfigError as error:
            return str(error), error.line, error.key

    def test_give_the_figures_of_the_module_without_fits_and_times(self):
        run = tactus.simulate(tactus.Scene(SCENE))
        figures = json.loads(tactus._core.figures(run.scene._core))
        del run.summary["step_time_ns"]
        for summary in (figures, run.summary):
            del summary["real_time_factor"]
        self.assertGreater(len(run.contacts), 0)
        for contact in run.summary["contacts"]:
            self.assertIsNotNone(contact["contact_stiffness_N_per_m"])
            contact["contact_stiffness_N_per_m"] = None
        self.assertEqual(figures.pop("path_left_s"), 0)  # which no summary has
        self.assertEqual(figures, run.summary)


class Hidden(Sweeps):
    """What a force and an error that are good do not tell."""

    def answer(self, text, limits):
        folder = self.folder / f"out{len(list(self.folder.glob('out*')))}"
        done = self.sweep(self.study(f"{text}limits: {limits}\n"), folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        page = html.unescape((folder / "report.html").read_text())
        for note in re.findall("(?m)^.* runs within the limits .*$", done.stdout):
            self.assertIn(f"<p>{note}.</p>", page)
        return done.stdout, rows_of(folder), page

    def test_is_a_path_that_waits(self):
        text = f"scenes: [{SCENES}/scenario2_estimated.yaml]\ngrid: {{task.wait_beyond_m: [0.002, 10]}}\n"
        said, rows, _ = self.answer(text, "{peak_force_N: 10}")
        run_ = tactus.simulate(tactus.Scene(SCENES / "scenario2_estimated.yaml", set={"task.wait_beyond_m": 0.002}))
        left_s = float(rows[0]["path_left_s"])
        self.assertGreater(left_s, 1)
        self.assertLessEqual(left_s, run_["t_s"][-1] - run_["path_time_s"][-1])
        self.assertEqual(float(rows[1]["path_left_s"]), 0)
        self.assertRegex(said, "(?m)^best: task.wait_beyond_m=0.002$")
        self.assertIn(f"\n1 runs within the limits did not come to the end of their path, up to {left_s:.3g} s of it "
                      "are left: limit path_left_s\n", said)
        said, _, _ = self.answer(text, "{peak_force_N: 10, path_left_s: 0}")
        self.assertRegex(said, "(?m)^best: task.wait_beyond_m=10$")
        self.assertNotIn("are left", said)

    def test_is_a_module_that_was_lost(self):
        text = (f"scenes: [{SCENES}/whole_arm/crops9_skin_two_links.yaml]\n"
                "set: {robot.module_lost: go_on_slowly, simulation.tactile_module.lost_share: 0.3}\n"
                "grid: {robot.module_lost_speed_share: [0.05]}\n")
        said, [row], _ = self.answer(text, "{peak_force_N: 10}")
        self.assertGreater(int(row["module_losses"]), 0)
        self.assertIn(f"\n1 runs within the limits lost a module, up to {row['module_losses']} times: limit "
                      "module_losses\n", said)
        self.assertIn("\n1 runs within the limits did not come to the end of their path, ", said)
        said, _, _ = self.answer(text, "{module_losses: 0}")
        self.assertNotIn("lost a module", said)

    def test_is_a_push_where_no_module_is(self):
        text = (f"scenes: [{SCENES}/whole_arm/crops9_skin_one_link.yaml]\nset:\n"
                "  simulation.obstacles[0].stiffness_N_per_m: 20000\n"
                "grid:\n  simulation.obstacles[0].post.foot_m[0]: [1.0]\n"
                "  simulation.obstacles[0].post.foot_m[1]: [0.3]\n")
        said, [row], page = self.answer(text, "{peak_force_N: 6}")
        pushed = float(row["unsensed_force_N"])
        self.assertIn(f"\n1 runs within the limits push up to {pushed:.4g} N where no module is: limit "
                      "unsensed_force_N\n", said)
        for kind in ("front", "best", "worst"):
            part = page[page.index(f'<table class="{kind}">'):]
            self.assertIn(f"<td>{pushed:.4g}</td>", part[:part.index("</table>")])


class Checks(Sweeps):
    """Of the best, as `tactus check` says it of their values."""

    def test_say_which_are_refused(self):
        scene, grid = SCENES / "scenario3_estimated.yaml", ("0.01", "0.1")
        study_ = self.study(f"scenes: [{scene}]\ngrid: {{controller.time_constant_s: [{', '.join(grid)}]}}\n"
                            "set: {simulation.duration_s: 1}\n"
                            "disturbances: {draws: 2, keys: {simulation.tactile_module.seed: [1, 2]}}\n")
        done = self.sweep(study_, self.folder / "out")
        said = {T: program("check", scene, "--set", f"controller.time_constant_s={T}", "--json") for T in grid}
        self.assertEqual([answer.returncode for answer in said.values()], [1, 0])
        reason = said["0.01"].stderr.strip().split(": ", 1)[1]
        margin = min(loop["phase_margin_deg"] for loop in json.loads(said["0.1"].stdout)["stability"]["loops"])
        self.assertIn(f"\nbest: controller.time_constant_s=0.01 (refused by tactus check: {reason})\n", done.stdout)
        page = html.unescape((self.folder / "out/report.html").read_text()).replace("\xa0", " ")
        part = page[page.index('<table class="best">'):]
        for T, text in (("0.01", f"refused: {reason}"), ("0.1", f"phase margin {margin:.1f}°")):
            self.assertRegex(part, rf'<th scope="row">controller.time_constant_s={T}</th>.*<td>{re.escape(text)}</td>')
        best = json.loads(self.sweep(study_, self.folder / "out", "--json").stdout)["best"]
        self.assertEqual((best["refusal"], best["phase_margin_deg"]), (reason, None))

    def test_are_of_all_scenes(self):
        scenes_ = [SCENES / "scenario3_estimated.yaml", SCENE]
        study_ = self.study(f"scenes: {json.dumps(list(map(str, scenes_)))}\nset: {{simulation.duration_s: 0.1}}\n"
                            "grid: {controller.time_constant_s: [0.1, 0.02]}\n")
        read = study.read_study(study_)
        plan = study.make_plan(read, scenes.load_files(read))
        rows = [{"run": number, **run(plan.files(number), plan.settings(number))} for number in range(plan.runs)]
        judge.judge(read, rows)
        good, bad = sorted(check.check_candidates(read, plan, judge.candidates(plan, rows)),
                           key=lambda one: one.refusal)
        margins = [loop["phase_margin_deg"] for scene in scenes_ for loop in tactus.Scene(
            scene, set={"controller.time_constant_s": 0.1}).check()["stability"]["loops"]]
        self.assertEqual((good.refusal, good.margin_deg), ("", min(margins)))
        self.assertRegex(bad.refusal, rf"is unstable .*, in {re.escape(str(scenes_[0]))}$")


class Figures(unittest.TestCase):
    def test_are_those_of_the_summary(self):
        path = SCENE.with_name("ur5e_contact.yaml")
        for components in ("[x]", "[x, rz]"):
            settings = {"simulation.duration_s": "1.5", "task.components": components}
            scene = tactus.Scene(path, set=settings)
            row = run(scene._core.sources(), [f"{key}={value}" for key, value in settings.items()])
            summary = tactus.simulate(scene).summary
            for name in _sweep.FIGURES:
                self.assertEqual(row[name], summary.get(name), name)
            self.assertEqual(row["tcp_rotation_error_max_rad"] is None, components == "[x]")

    def test_of_contacts_are_unknown_where_one_is(self):
        contact = {"settling_s": 0.5, "time_above_s": 1.0, "swing_N": 0.2}
        longer = {"settling_s": 0.7, "time_above_s": 0.9, "swing_N": None}
        for contacts, further, expected in (([], {}, (0, None, None, None)), ([contact], {}, (1, 0.5, 1.0, 0.2)),
                                            ([contact, longer], {}, (2, 0.7, 1.0, None)),
                                            ([contact], {"further_contacts": 3}, (4, None, None, None))):
            figures = _sweep._figures({"contacts": contacts, **further})
            self.assertEqual(tuple(figures[name] for name in ("contacts", *_sweep.OF_CONTACTS)), expected)


class BadStudies(Sweeps):
    def refuse(self, text, expected, exit_code=1):
        study = self.study(text)
        done = self.sweep(study, self.folder / "out")
        self.assertEqual((done.returncode, done.stdout), (exit_code, ""), done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertRegex(done.stderr.replace(str(study), "study.yaml"), expected)
        self.assertFalse((self.folder / "out").exists())

    def test_are_refused_with_their_place(self):
        begin = f"scenes: [{SCENE}]\n"
        for text, expected in (
                ("", r"^study.yaml:1:1: -: an empty file, expected a study"),
                ("[1]", r":1:1: -: a list, expected a section"),
                ("foo: 1", r":1:1: foo: unknown key, expected one of scenes, "),
                ("grid: {}", r":1:1: -: without scenes, "),
                ("scenes: []", r":1:9: scenes: an empty list, "),
                ("scenes: [gone.yaml]", r":1:10: scenes\[0\]: 'gone.yaml' is no file, "),
                ("scenes: [a\x07b]", r"^study.yaml:1:11: -: the character #x07, expected YAML"),
                ("scenes:\n- ä\n\n- bc\x1b[2J\n", r"^study.yaml:4:5: -: the character #x1b, expected YAML"),
                ("scenes: &a [b]\nset: *a", r":2:6: -: an alias, "),
                (begin + begin, r":2:1: scenes: is there twice, "),
                (begin + "grid: {controller.damping: [0.5", r"expected YAML"),
                (begin + "set: {simulation.obstacles[0].x_m: 1}", r":2:27: -: .*got '\[', expected a key with \[ \] in "
                 "quotes, or on a line of its own"),
                (begin + "grid: {controller.damping: []}", r":2:28: grid.controller.damping: an empty list, "),
                (begin + "grid: {controller.damping: [1, 1]}", r"'1' is there twice"),
                (begin + "grid: {controller.damping: [0.5, 0.7, 0.50]}", r"'0.50' is there twice"),
                (begin + "grid: {controller.dampin: [1]}", r":2:8: controller.dampin: unknown key, .*'damping'"),
                (begin + "grid:\n  controller.damping: [1, -2]", r":3:3: controller.damping: '-2' is out of "),
                (begin + "set: {nowhere.a: 1, nowhere.b: 2}", r":2:7: nowhere: unknown key, "),
                (begin + "grid: {nowhere.a: [1, 2], nowhere.b: [1, 2]}", r":2:8: nowhere: unknown key, "),
                (begin + "set: {controller.variant: 3}", r":2:7: controller.variant: '3', expected one of"),
                (begin + "grid: {controller.damping: {from: 1, to: 11, count: 2}}", r"'11.0' is out of range"),
                (begin + "grid: {controller.damping: {from: 1, to: 1, count: 2}}", r"1 is not above from, 1"),
                (begin + "grid: {controller.damping: {from: 0.5, to: .inf, count: 2}}", r"'.inf', expected a f"),
                (begin + "grid: {controller.damping: {from: 0_1, to: 2, count: 2}}", r":2:35: .*'0_1', expected a f"),
                (begin + "grid: {controller.damping: {from: '1', to: 2, count: 2}}", r"the text '1', expected a fin"),
                (begin + "grid: {controller.damping: {from: 1, to: 2, count: '2'}}", r"the text '2', expected a who"),
                (begin + "grid: {controller.damping: {from: 1, to: 2, count: ٢}}", r"'٢', expected a whole number"),
                (begin + "limits: {peak_force_N: \"5\"}", r":2:24: limits.peak_force_N: the text '5', expected a f"),
                (begin + "grid: {a: {from: 1, to: 2, count: 2, whole: 'true'}}", r"the text 'true', expected true or"),
                (begin + "grid: {controller.damping: {from: 0.5, to: 1, count: 1}}", r"'1', expected a whole"),
                (begin + "grid: {controller.damping: {from: 0, to: 1, count: 2, scale: log}}", r"scale is log"),
                (begin + "grid: {controller.damping: {from: 0.7, to: 0.700002, count: 5}}", r"5 values that 6 dig"),
                (begin + "grid: {simulation.tactile_module.seed: {from: 1, to: 10, count: 4, scale: log, whole: true}}",
                 r"with scale log"),
                (begin + "grid: {simulation.tactile_module.seed: {from: 1, to: 10, count: 5, whole: true}}",
                 r":2:\d+: .*seed.count: 5 values from 1 to 10 are not whole, expected a count that parts"),
                (begin + "sobol: {points: 3, keys: {controller.damping: [1]}}", r":2:17: .*a power of 2"),
                (begin + "sobol: {points: 4}", r"sobol: without keys"),
                (begin + "disturbances: {draws: 2, keys: {controller.damping: {mean: 1, "
                 "standard_deviation: 0}}}", r"'0', expected a number > 0"),
                (begin + "set: {controller.damping: 1}\ngrid: {controller.damping: [1]}",
                 r":3:\d+: grid.controller.damping: has its values elsewhere"),
                (begin + "set: {'a.b[0].c': 1}\ngrid: {'a.b[000].c': [1]}", r":3:\d+: grid.a.b\[000\].c: has its val"),
                (begin + "set: {'a[10]': 1, 'a[010]': 1}", r":2:\d+: set.a\[010\]: has its values elsewhere"),
                (begin + "grid: {a.b.c: [1], a.bc: [1], a.b0: [1], a.b: [1]}",
                 r":2:\d+: grid.a.b: takes the place of a.b.c, which is before, expected one of them"),
                (begin + "set: {'a[1].b': 1}\ngrid: {'a[10].b': [1], 'a[01]': [1]}",
                 r":3:\d+: grid.a\[01\]: takes the place of a\[1\].b, "),
                (begin + "grid: {'a[0]': [1], a: [1]}", r":2:\d+: grid.a: takes the place of a\[0\], "),
                (begin + "grid: {controller.damping: {from: 0.5, to: 1, count: 1001}, "
                 "controller.time_constant_s: {from: 0.1, to: 1, count: 1001}}", r"1002001 runs, expected at"),
                (begin + "grid: {robot: [a.yaml, b.yaml]}", r":2:15: grid.robot: a file cannot vary within a study, "
                 "expected a scene for each in scenes"),
                (begin + "sobol: {points: 2, keys: {robot.urdf: [a, b]}}", r"robot.urdf: a file cannot vary"),
                (begin + "disturbances: {draws: 2, keys: {'robot.drives.joints[0].profile': [a, b]}}",
                 r"profile: a file cannot vary"),
                (begin + "set: {robot: nowhere.yaml}", r":2:7: robot: .*nowhere.yaml: No such file or directory, "),
                (begin + "limits: {peak: 1}", r"limits.peak: unknown key"),
                (begin + "objective: nothing", r"'nothing', expected one of peak_force_N")):
            with self.subTest(text=text):
                self.refuse(text, expected)

    def test_are_not_those_with_numbers_as_scenes_take_them(self):
        for text, number in (("+.5", 0.5), ("5.", 5.0), ("-1.5e-3", -0.0015), ("2E+1", 20.0), ("007", 7.0)):
            read = study.read_study(self.study(f"scenes: [a]\nlimits: {{peak_force_N: {text}}}\n"))
            self.assertEqual(read.limits, {"peak_force_N": number})

    def test_are_not_those_with_keys_that_begin_alike(self):
        keys = ["a", "ab", "b[1].c", "b[10].c", "b[11].c", "b[1].cd", "c.d", "c.d0", "c.d_e", "b[100].c"]
        for order in (keys, keys[::-1]):
            read = study.read_study(self.study("scenes: [a]\ngrid:\n" + "".join(f"  {key}: [1]\n" for key in order)))
            self.assertEqual([axis.key for axis in read.axes], order)

    def test_are_not_those_with_a_section_before_its_keys(self):
        read = study.read_study(self.study("scenes: [a]\nset: {a: [{b: 1, c: 1}]}\n"
                                           "grid: {'a[0].b': [1], 'a[0].c': [1]}"))
        self.assertEqual(len(read.axes), 2)

    def test_are_refused_without_a_folder(self):
        for name in ("study.yaml", "gone.yaml"):
            self.study()
            done = self.sweep(name, "", cwd=self.folder)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertEqual(done.stderr, "-:1:1: -o: no folder, expected a path\n")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["study.yaml"])
        answer = json.loads(self.sweep("study.yaml", "", "--json", cwd=self.folder).stdout)
        self.assertEqual(answer, {"done": False, "error": "-:1:1: -o: no folder, expected a path"})

    def test_name_what_is_wrong_with_a_scene(self):
        self.file("scene.yaml", f"extends: {SCENE}\ncontroller:\n  damping: x\n")
        self.refuse("scenes: [scene.yaml]", r"scene.yaml:3:12: controller.damping: 'x' is not a number")

    def test_may_have_scenes_that_are_whole_with_what_they_set(self):
        """As --set makes them; another robot, and the mistake of another key is still found."""
        self.file("scene.yaml", f"extends: {SCENE}\ncontroller: {{damping: null, time_constant_s: 0.0001}}\n")
        robot = self.file("robot.yaml", (ROOT / "config/robots/planar2/robot.yaml").read_text()
                          .replace("urdf: ", f"urdf: {ROOT}/config/robots/planar2/"))
        text = (f"scenes: [scene.yaml]\nset: {{controller.time_constant_s: 0.1, simulation.duration_s: 0.1, "
                f"robot: {robot}}}\ngrid: {{controller.damping: [0.5, 0.7]}}\n")
        done = self.sweep(self.study(text), self.folder / "out")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("2 completed", done.stdout)
        self.assertIn(str(robot), (self.folder / "out/results.jsonl").read_text())
        shutil.rmtree(self.folder / "out")
        for scene in ("scene.yaml", SCENE):
            self.refuse(text.replace("scene.yaml", str(scene)).replace("duration_s: 0.1", "duration: 0.1"),
                        r"^study.yaml:2:\d+: simulation.duration: unknown")
        self.refuse(text.replace("time_constant_s: 0.1", "activation_force_N: 5"),
                    r"scene.yaml:2:\d+: controller.time_constant_s: '0.0001' is out of range")

    def test_are_usage_where_options_are(self):
        for arguments in ((), ("-o", "out", "-j", "0"), ("-o", "out", "--nonsense")):
            done = subprocess.run([TACTUS, "sweep", self.study(), *arguments], capture_output=True, cwd=self.folder)
            self.assertEqual(done.returncode, 2)


class Ranges(Sweeps):
    def settings(self, grid):
        text = f"scenes: [{SCENE}]\ngrid: {{simulation.tactile_module.seed: {{{grid}}}}}\n"
        read = study.read_study(self.study(text))
        plan = study.make_plan(read, scenes.load_files(read))
        scenes.check_keys(read, plan)
        return [plan.settings(run)[0].split("=")[1] for run in range(plan.runs)]

    def test_of_the_grid_may_be_whole(self):
        self.assertEqual(self.settings("from: 1, to: 10, count: 4, whole: true"), ["1", "4", "7", "10"])
        self.assertEqual(self.settings("from: 9007199254740, to: 9007199254742, count: 3, whole: true"),
                         ["9007199254740", "9007199254741", "9007199254742"])
        with self.assertRaisesRegex(study.StudyError, "'1.0' is not a whole number"):
            self.settings("from: 1, to: 10, count: 4")


class Texts(Scratch):
    def settings(self, text):
        read = study.read_study(self.file("study.yaml", f"scenes: [a]\nset:\n  k: {text}\n"))
        return [setting.removeprefix("k=") for _, setting in read.fixed]

    def test_in_one_line_are_set_as_they_stand(self):
        for text in ("\"ti  p\"", "'  ti \t p '", "\"a # b\"", "'#'", "[1,  'a  b',  2]", "{a:  'b  c'}", "['a#b']",
                     "''", "a  b"):
            with self.subTest(text=text):
                self.assertEqual(self.settings(text), [text])
        self.assertEqual(self.settings("'a  b' # c"), ["'a  b'"])

    def test_in_several_lines_become_one(self):
        self.assertEqual(self.settings("[1,\n    2]"), ["[1, 2]"])
        self.assertEqual(self.settings("'a\n    b'"), ["'a b'"])
        for text in ("[1, # one\n    2]", "|\n    a", "\n    a: 1", "\n    - 1"):
            with self.subTest(text=text), self.assertRaisesRegex(study.StudyError, "a value, or a list or section in"):
                self.settings(text)

    def test_of_a_robot_keep_their_blanks(self):
        text = f"scenes: [{SCENE}]\nset: {{robot.tip: \"ti  p\"}}\n"
        read = study.read_study(self.file("study.yaml", text))
        with self.assertRaisesRegex(study.StudyError, "'ti  p'"):
            scenes.check_keys(read, study.make_plan(read, scenes.load_files(read)))


class Conflicts(Sweeps):
    """Values that are possible, but not together: found by their runs, whatever the order of the study."""

    BEGIN = f"scenes: [{SCENE}]\nset: {{simulation.duration_s: 0.1}}\n"
    VANISHES, APPEARS = "'simulation.obstacles[0].vanishes_s'", "'simulation.obstacles[0].appears_s'"

    def read(self, text):
        read = study.read_study(self.study(text))
        plan = study.make_plan(read, scenes.load_files(read))
        scenes.check_keys(read, plan)
        return plan

    def refusals(self, text):
        plan = self.read(text)
        rows = [run(plan.files(number), plan.settings(number)) for number in range(plan.runs)]
        return sum(row["outcome"] == "refused" for row in rows)

    def test_are_rows_in_any_order_of_values_and_keys(self):
        for vanishes, appears in itertools.product(("[2, 5]", "[5, 2]", "[5, 2, 5.5]"),
                                                   ("[3, 1]", "[1, 3]", "[3, 1, 4]")):
            lines = [f"{self.VANISHES}: {vanishes}", f"{self.APPEARS}: {appears}"]
            late = sum(float(a) > 2 for a in json.loads(appears))
            for text in (lines, lines[::-1]):
                with self.subTest(text=text):
                    self.assertEqual(self.refusals(f"{self.BEGIN}grid: {{{', '.join(text)}}}"), late)

    def test_are_rows_whatever_section_the_keys_are_in(self):
        for text in (f"grid: {{{self.VANISHES}: [2, 5]}}\n"
                     f"disturbances: {{draws: 20, keys: {{{self.APPEARS}: {{from: 1, to: 4}}}}}}",
                     f"sobol: {{points: 16, keys: {{{self.VANISHES}: {{from: 2, to: 5}}}}}}\n"
                     f"disturbances: {{draws: 3, keys: {{{self.APPEARS}: {{from: 1, to: 4}}}}}}"):
            with self.subTest(text=text):
                plan = self.read(self.BEGIN + text)
                self.assertTrue(0 < self.refusals(self.BEGIN + text) < plan.runs)

    def scene(self, obstacles):
        begin, mark, _ = SCENE.read_text().partition("  obstacles:")
        text = begin.replace("planar2_free.yaml", str(SCENE.with_name("planar2_free.yaml")))
        return self.BEGIN.replace(str(SCENE), str(self.file("scene.yaml", f"{text}{mark} {obstacles}\n")))

    def test_of_two_obstacles_do_not_hide_one_another(self):
        begin = self.scene("[{x_m: 0.51, y_m: 0.124, stiffness_N_per_m: 300}, "
                           "{x_m: 0.6, y_m: 0.3, stiffness_N_per_m: 300}]")
        others = [key.replace("[0]", "[1]") for key in (self.VANISHES, self.APPEARS)]
        for vanishes, appears in (("[2, 5]", "[3, 1]"), ("[5, 2]", "[1, 3]")):
            grid = (f"grid: {{{self.VANISHES}: [2, 5], {self.APPEARS}: [3, 1], {others[0]}: {vanishes}, "
                    f"{others[1]}: {appears}")
            self.assertEqual(self.refusals(f"{begin}{grid}}}"), 16 - 3 * 3)
            with self.assertRaisesRegex(study.StudyError, r"controller.damping: '-1' is out of range"):
                self.read(f"{begin}{grid}, controller.damping: [0.5, -1]}}")

    def test_of_what_is_set_with_the_scene_are_none_of_the_study(self):
        begin = self.scene("[{x_m: 0.51, y_m: 0.124, stiffness_N_per_m: 300, appears_s: 3}]")
        text = begin.replace("{", f"{{{self.VANISHES}: 2, ") + f"grid: {{{self.APPEARS}: "
        self.assertEqual(self.refusals(text + "[3, 1]}"), 1)
        with self.assertRaisesRegex(study.StudyError, ":2:7: .*vanishes_s: 2 s is too early"):
            self.read(text + "[3, 4]}")  # no run could be

    def test_with_all_values_refuse_the_study(self):
        for appears in ("[3, 4]", "[4, 3]"):
            with self.assertRaisesRegex(study.StudyError, r":3:8: simulation.obstacles\[0\].vanishes_s: 2 s is too "
                                                          "early, expected more than appears_s = [34], in "):
                self.read(f"{self.BEGIN}grid: {{{self.VANISHES}: [2, 5], {self.APPEARS}: {appears}}}")


class Shipped(unittest.TestCase):
    """Studies that come along, and the one of the document: no key is wrong."""

    def test_are_right(self):
        text = (ROOT / "docs/sweeps.md").read_text()
        [shown] = re.findall(r"```yaml\n(# my_study.yaml\n.*?)```", text, re.S)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "my_study.yaml"
            path.write_text(shown.replace("config/", f"{ROOT}/config/"))
            plans = [self.plan(path), *map(self.plan, sorted((ROOT / "config/studies").glob("*.yaml")))]
        self.assertGreater(len(plans), 1)
        self.assertIn(f"This one has {plans[0].runs:,}.".replace(",", " "), text)

    def plan(self, path):
        read = study.read_study(path)
        plan = study.make_plan(read, scenes.load_files(read))
        scenes.check_keys(read, plan)
        return plan


class Workers(Scratch):
    def test_that_read_nothing_are_given_up(self):
        """A plan with its scenes is more than a pipe takes."""
        hung = self.file("python", "#!/bin/sh\nexec sleep 1000\n")
        hung.chmod(0o755)
        plan = mock.Mock(as_json=lambda: {"scenes": "x" * 1_000_000})
        with mock.patch.object(pool.sys, "executable", str(hung)), mock.patch.multiple(pool, START_S=1, LOOK_S=0.1):
            workers = pool.Pool(plan, 2, {})
            self.addCleanup(workers.close)
            with self.assertRaisesRegex(pool.PoolError, "a worker process has not begun within 1 s"):
                list(workers.rows([0, 1]))


class Judgement(unittest.TestCase):
    def test_front_is_what_nothing_beats(self):
        random = np.random.default_rng(3)
        for size in (1, 2, 50):
            points = random.integers(0, 8, (size, 2)).astype(float)  # with ties
            found = [judge.Candidate((i,), [], 0.0, *point, True) for i, point in enumerate(points)]
            got = {(one.force_N, one.error_m) for one in judge.front(found)}
            wanted = {tuple(p) for p in points if not any(
                (q <= p).all() and (q < p).any() for q in points)}
            self.assertEqual(got, wanted)
            self.assertEqual(len(judge.front(found)), len(wanted))

    def test_rank_correlation_is_that_of_scipy(self):
        random = np.random.default_rng(4)
        for values in (5, 1000):
            x, y = random.integers(0, values, 200), random.integers(0, values, 200)
            y = y + x // 2
            self.assertAlmostEqual(judge.rank_correlation(x, y), stats.spearmanr(x, y)[0], 12)
        self.assertTrue(math.isnan(judge.rank_correlation(x, 0 * y)))

    def test_share_of_the_variance_is_that_of_a_known_sum(self):
        """y = 3 a + b with equal variances: a explains 9 of 10, what is not there nothing."""
        random = np.random.default_rng(5)
        a, b, c = random.random((3, 4000))
        for x, share in ((a, 0.9), (b, 0.1), (c, 0.0)):
            self.assertAlmostEqual(judge.variance_share(x, 3 * a + b), share, delta=0.02)
        levels = np.floor(a * 4)
        self.assertAlmostEqual(judge.variance_share(levels, levels), 1.0, 12)
        few = np.array([judge.variance_share(random.random(40), random.random(40)) for _ in range(300)])
        self.assertLess(few.mean(), 0.06)  # chance does not look like a cause

    def test_what_nobody_knows_keeps_no_limit(self):
        limits = {"peak_force_N": 5.0, "swing_N": 0.5, "unsensed_force_N": 20.0}
        judged = types.SimpleNamespace(objective={"peak_force_N": 1.0}, limits=limits)
        known = {"outcome": "completed", "peak_force_N": 4.0, "contacts": 2, "swing_N": 0.1, "unsensed_force_N": 0.0}
        for changed, is_within in (({}, True), ({"swing_N": 0.6}, False), ({"swing_N": None}, False),
                                   ({"swing_N": None, "contacts": 0}, True), ({"unsensed_force_N": None}, False),
                                   ({"unsensed_force_N": None, "contacts": 0}, False),
                                   ({"peak_force_N": None}, False)):
            row = {**known, **changed}
            judge.judge(judged, [row])
            self.assertEqual(row["is_within"], is_within, changed)

    def test_a_run_without_contacts_has_an_objective_of_contacts(self):
        judged = types.SimpleNamespace(objective={"peak_force_N": 1.0, "settling_s": 2.0}, limits={})
        touched = {"outcome": "completed", "peak_force_N": 4.0, "contacts": 1, "settling_s": 0.5}
        for changed, objective in (({}, 5.0), ({"contacts": 0, "settling_s": None}, 4.0),
                                   ({"settling_s": None}, math.inf), ({"peak_force_N": None}, math.inf),
                                   ({"outcome": "drive_fault"}, math.inf)):
            row = {**touched, **changed}
            judge.judge(judged, [row])
            self.assertEqual(row["objective"], objective, changed)

    def test_of_an_unknown_objective_are_not_the_worst_runs(self):
        plan = types.SimpleNamespace(place=lambda _: (0,), settings=lambda _: [])
        judged = types.SimpleNamespace(path=pathlib.Path("s.yaml"), scenes=[(None, "a.yaml", pathlib.Path("a.yaml"))])
        rows = [{"run": run, "outcome": "completed", "peak_force_N": 1.0, "tcp_error_max_m": 0.01,
                 "objective": objective, "is_within": True} for run, objective in enumerate((1.0, math.inf, 3.0))]
        page = "".join(study_page.worst_section(judged, plan, rows))
        self.assertEqual(re.findall(r'<th scope="row">(\d+)</th>', page), ["2", "0", "1"])
        self.assertIn("Objective unknown for 1 runs", page)
        self.assertNotIn("unknown", "".join(study_page.worst_section(judged, plan, rows[:1])))

    def test_of_progress(self):
        self.assertEqual(progress.progress_text(50, 100, 10, 20.0), "50 of 100 runs, 50 %, 100 s left".replace(
            "100 s", "2 min"))
        self.assertEqual(progress.progress_text(90, 100, 10, 20.0), "90 of 100 runs, 90 %, 20 s left")
        self.assertEqual(progress.progress_text(0, 100, 0, 20.0), "0 of 100 runs, 0 %")


if __name__ == "__main__":
    unittest.main()
