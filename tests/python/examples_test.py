#!/usr/bin/env python3
"""The examples that use the module do what they say; the loop of the one for MuJoCo with an engine of its
own, a spring, as well.

usage: examples_test.py FOLDER TACTUS"""

import json
import os
import re
import subprocess
import sys
import unittest

import numpy as np
from common import FOLDER, ROOT, SCENES, Scratch, program, tactus

sys.path.insert(0, str(ROOT / "examples"))
import behind_mujoco  # noqa: E402

POST = (0.70771, 0.00265)


def example(name, *arguments):
    return subprocess.run([sys.executable, ROOT / "examples" / name, *map(str, arguments)], text=True,
                          capture_output=True, timeout=300, env=os.environ | {"PYTHONPATH": str(FOLDER)})


class Tuning(Scratch):
    def test_shows_what_the_program_says_and_picks_the_best(self):
        done = example("tune_stiff_profile.py", "--T", "0.05", "0.1", "--d", "0.5", "0.7")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line.split() for line in done.stdout.splitlines()[1:-1]]
        self.assertEqual([row[:2] for row in rows],
                         [["0.05", "0.5"], ["0.05", "0.7"], ["0.1", "0.5"], ["0.1", "0.7"]])
        peaks = {}
        for time_constant, damping, *figures in rows:
            settings = ("--set", f"controller.time_constant_s={time_constant}",
                        "--set", f"controller.damping={damping}")
            scene = SCENES / "scenario3_estimated.yaml"
            if program("check", scene, *settings).returncode != 0:
                self.assertEqual(figures, ["refused:", "unstable"])
                continue
            said = program("simulate", scene, "-o", self.folder, "--json", *settings)
            peaks[time_constant, damping] = json.loads(said.stdout)[0]["peak_force_N"]
            self.assertEqual(figures[1], f"{peaks[time_constant, damping]:.2f}")
        self.assertEqual(len(peaks), 2)
        best = re.fullmatch(r"best: T = (\S+) s, d = (\S+)", done.stdout.splitlines()[-1])
        self.assertEqual(best.groups(), min(peaks, key=peaks.get))

    def test_says_what_the_best_pushes_where_no_module_is(self):
        post = "post: {foot_m: [1.0, 0.3, 0.2], axis: [0, 0, 1], height_m: 0.7, radius_m: 0.02}"
        scene = self.file("bare.yaml", f"extends: {SCENES}/whole_arm/crops9_skin_one_link.yaml\n"
                                       f"simulation:\n  obstacles:\n    - {{{post}, stiffness_N_per_m: 20000}}\n")
        done = example("tune_stiff_profile.py", scene, "--T", "0.1", "--d", "0.7")
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = tactus.simulate(tactus.Scene(scene, set={"controller.damping": 0.7,
                                                           "controller.time_constant_s": 0.1})).summary
        pushed = f"{summary['unsensed_contact']['force_N']:.1f}"
        self.assertGreater(float(pushed), 10)
        _, row, told, _ = done.stdout.splitlines()
        self.assertEqual(row.split()[6], pushed)
        self.assertEqual(told, f"the best pushes with up to {pushed} N where no module is")

    def test_finds_none_where_none_is_fit(self):
        done = example("tune_stiff_profile.py", "--T", "0.1", "--d", "0.7", "--max-tool-error-mm", "1")
        self.assertEqual((done.returncode, done.stdout.splitlines()[-1]), (3, "none is fit"))

    def test_says_what_is_wrong(self):
        done = example("tune_stiff_profile.py", self.folder / "nix.yaml")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^\S+nix.yaml:1:1: -: [^\n]*\n$")
        done = example("tune_stiff_profile.py", SCENES / "scenario1_none.yaml")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^\S+scenario1_none.yaml: without force control [^\n]*\n$")
        hasty = self.file("hasty.yaml", f"extends: {SCENES}/scenario3_estimated.yaml\nperiod_s: 0.0005\n")
        done = example("tune_stiff_profile.py", hasty, "--T", "0.1", "--d", "0.5")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, r"^\S+: can.buses\[0\]: can0 is overloaded: [^\n]*\n$")


class Plotting(Scratch):
    def test_draws_each_contact(self):
        program("simulate", SCENES / "whole_arm/crops9_skin_two_links.yaml", "-o", self.folder)
        log, page = self.folder / "crops9_skin_two_links/run.ulg", self.folder / "contacts.png"
        done = example("plot_contacts.py", log, "-o", page)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(page.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        contacts = json.loads(program("contacts", log, "--json").stdout)
        self.assertEqual(len({contact["tactile_module"] for contact in contacts}), 2)
        for line, contact in zip(done.stdout.splitlines(), contacts):
            self.assertIn(f"on {contact['tactile_module']}: at most {contact['peak_force_N']:.2f} N", line)
        self.assertIn(f"{len(contacts)} contacts, ", done.stdout.splitlines()[-1])

    def test_says_what_is_wrong(self):
        done = example("plot_contacts.py", self.file("run.ulg", "no log"))
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^\S+run.ulg:1:[^\n]*\n$")
        program("simulate", SCENES / "robots/planar2_free.yaml", "-o", self.folder)
        done = example("plot_contacts.py", self.folder / "planar2_free/run.ulg", "-o", self.folder / "contacts.xyz")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^Format 'xyz' is not supported [^\n]*\n$")


class Spring:
    """In MuJoCo's place: an arm that follows at once, and a vertical line that gives way like a spring."""

    def __init__(self, scene, stiffness_N_per_m):
        self.q = scene.q_start.copy()
        self.stiffness_N_per_m = stiffness_N_per_m
        self.radius_m, self.length_m = (scene.numbers[f"tactile_module.{name}"]
                                        for name in ("cover_radius_m", "length_m"))

    def positions(self):
        return self.q.copy()

    def tactile(self, module_poses):
        (R, p) = module_poses[0][:3, :3], module_poses[0][:3, 3]
        along, off = R[:2, 0], np.array(POST) - p[:2]
        x_m = np.clip(along @ off / (along @ along), 0, self.length_m)
        away = x_m * along - off
        pressed_m = self.radius_m - np.linalg.norm(away)
        if pressed_m <= 0:
            return np.zeros((1, 4))
        force = R.T @ np.append(self.stiffness_N_per_m * pressed_m * away / np.linalg.norm(away), 0)
        moment = np.cross([x_m, 0, 0], force)
        return [[force[1], force[2], moment[1], moment[2]]]

    def step(self, dq, period_s):
        self.q += dq * period_s


class OtherEngines(unittest.TestCase):
    def run_with(self, name, stiffness_N_per_m):
        scene = tactus.Scene(SCENES / f"{name}.yaml")
        return behind_mujoco.run(scene, Spring(scene, stiffness_N_per_m), 8.0)

    def test_are_met_with_the_force_that_the_scene_asks_for(self):
        obstacle = {"x_m": POST[0], "y_m": POST[1], "stiffness_N_per_m": 1000}
        ours = tactus.simulate(tactus.Scene(SCENES / "scenario1_tactus.yaml", set={
            "simulation.obstacles": [obstacle], "simulation.duration_s": 8}))
        fields, controller = self.run_with("scenario1_tactus", 1000)
        force = fields["force_sensor_N"]
        self.assertIsNone(controller.fault)
        self.assertLess(force.max(), 5.25)
        self.assertAlmostEqual(force[-1], 5.0, delta=0.02)  # F_act + F_th
        touches = [np.argmax(one > 0.5) for one in (force, ours["force_sensor_N"])]
        self.assertLess(abs(touches[0] - touches[1]), 50)
        for axis in "xyz":
            error_m = fields[f"tool_error_{axis}_m"] - ours[f"tool_error_{axis}_m"]
            self.assertLess(np.abs(error_m).max(), 5e-3, axis)

    def test_press_on_where_no_law_gives_way(self):
        fields, _ = self.run_with("scenario1_none", 300)
        self.assertGreater(fields["force_sensor_N"].max(), 15)


class BehindMujoco(unittest.TestCase):
    def test_takes_an_arm_with_one_module(self):
        for scene, modules in (("whole_arm/crops9_skin_in_turn", 3), ("free_motion", 0)):
            path = SCENES / f"{scene}.yaml"
            done = example("behind_mujoco.py", path)
            self.assertEqual((done.returncode, done.stdout, done.stderr),
                             (1, "", f"{path}: {modules} tactile modules, expected one\n"))


class WithoutMujoco(unittest.TestCase):
    def test_says_what_to_install(self):
        done = subprocess.run(
            [sys.executable, "-c", "import sys, runpy; sys.modules['mujoco'] = None; sys.argv = ['a']; "
             f"runpy.run_path({str(ROOT / 'examples/behind_mujoco.py')!r}, run_name='__main__')"],
            text=True, capture_output=True, env=os.environ | {"PYTHONPATH": str(FOLDER)})
        self.assertEqual(done.returncode, behind_mujoco.NO_MUJOCO)
        self.assertRegex(done.stderr, "install MuJoCo: pip install mujoco\n$")


if __name__ == "__main__":
    unittest.main()
