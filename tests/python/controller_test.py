#!/usr/bin/env python3
"""The controller alone: fed with what a simulation's sensors said it commands what the simulation did,
whatever else is asked of it, or of another one, in between.

usage: controller_test.py FOLDER TACTUS"""

import copy
import gc
import unittest

import numpy as np
from common import SCENES, TACTILE, tactus

CASES = {
    "scenario1_joint_space": {},
    "scenario3_tactus": {},
    "real/real_scenario3_mx": {},
    "robots/ur5e_contact": {},
    "whole_arm/crops9_skin_two_links": {},
    "scenario1_null_space": {"robot.tactile_modules[0].max_force_N": 4},  # ends with a fault
}
SKIN = "whole_arm/crops9_skin_two_links"


def load(name, settings=None):
    return tactus.Scene(SCENES / f"{name}.yaml", set={"simulation.duration_s": 5} | (settings or {}))


def inputs(run):
    """What update() takes, cycle by cycle."""
    names = [name for name in (*TACTILE, "tactile_moment_x_Nm") if name in run]
    by_module = [run[name].reshape(run.cycles, -1) for name in names]
    sequence = run["tactile_sequence"].reshape(run.cycles, -1)
    modules = run.scene.modules
    for cycle in range(run.cycles):
        tactile = np.stack([column[cycle] for column in by_module], axis=1) if modules else None
        yield run["q_measured"][cycle], tactile, sequence[cycle] if modules else None


class Loops(unittest.TestCase):
    def test_command_what_the_simulation_did(self):
        for name, settings in CASES.items():
            with self.subTest(scene=name):
                run = tactus.simulate(load(name, settings))
                controller = tactus.Controller(run.scene)
                for cycle, (q, tactile, sequence) in enumerate(inputs(run)):
                    dq = controller.update(q, tactile, sequence)
                    if not np.array_equal(dq, run["dq"][cycle]):
                        self.fail(f"cycle {cycle}: {dq} instead of {run['dq'][cycle]}")
                self.assertGreater(cycle, 1000)
                self.compare_last(controller, run)

    def compare_last(self, controller, run):
        self.assertEqual(controller.fault, run.fault)
        self.assertEqual(controller.mode, tactus.MODES[run["mode"][-1]])
        self.assertEqual(controller.is_at_rest, run.fault is not None)
        record = controller.record()
        self.assertEqual(set(record), set(run))
        for field in set(run) - {"step_ns"}:
            if field.startswith("tool_error") and "real" in run.scene.name:
                continue  # of an arm with gears only the simulation knows where its tool is
            self.assertTrue(np.array_equal(record[field], run[field][-1]), field)

    def test_of_a_copy_would_be_those_of_the_original(self):
        controller = tactus.Controller(load(SKIN))
        for copied in (copy.copy, copy.deepcopy):
            self.assertRaises(TypeError, copied, controller)

    def test_of_two_controllers_are_independent(self):
        runs = [tactus.simulate(load("scenario3_tactus")), tactus.simulate(load(SKIN)),
                tactus.simulate(load("scenario3_tactus", {"controller.time_constant_s": 0.15}))]
        controllers = [tactus.Controller(run.scene) for run in runs]
        for cycle, fed in enumerate(zip(*map(inputs, runs))):
            for run, controller, one in zip(runs, controllers, fed):
                self.assertTrue(np.array_equal(controller.update(*one), run["dq"][cycle]))

    def test_do_not_notice_an_input_that_was_refused(self):
        run = tactus.simulate(load(SKIN))
        controller = tactus.Controller(run.scene)
        joints, modules = len(run.scene.joints), len(run.scene.modules)
        q, tactile = np.zeros(joints), np.zeros((modules, 4))
        bad = [(q[:-1], tactile), (q[None], tactile), (q + np.inf, tactile), (q, tactile[:-1]),
               (q, tactile.T), (q, tactile * np.nan), (q, tactile, [1]), (q, tactile, [1, 2, -1]),
               (q, tactile, [1, 2, 1 << 32]), (3, tactile), ([], tactile), (q, [[]])]
        for cycle, one in enumerate(inputs(run)):
            with self.assertRaises(ValueError):
                controller.update(*bad[cycle % len(bad)])
            self.assertTrue(np.array_equal(controller.update(*one), run["dq"][cycle]), cycle)

    def test_need_new_samples(self):
        scene = load("scenario3_tactus")
        controller = tactus.Controller(scene)
        for _ in range(200):
            dq = controller.update(scene.q_start, np.zeros((1, 4)))
            self.assertTrue(np.isfinite(dq).all())
        self.assertIsNone(controller.fault)
        for _ in range(19):
            controller.update(scene.q_start)
        self.assertIsNone(controller.fault)
        for _ in range(10):
            controller.update(scene.q_start)
        self.assertIn("tactile", controller.fault)
        self.assertAlmostEqual(controller.time_s, 0.229)

    def test_outlive_what_they_were_made_of(self):
        run = tactus.simulate(load("scenario3_tactus"))
        controller = tactus.Controller(load("scenario3_tactus"))
        controller.scene = None
        gc.collect()
        for cycle, one in zip(range(500), inputs(run)):
            self.assertTrue(np.array_equal(controller.update(*one), run["dq"][cycle]))

    def test_take_what_numpy_takes(self):
        scene = load("scenario3_tactus")
        q = [round(x, 2) for x in scene.q_start]
        expected = tactus.Controller(scene).update(np.array(q), [[1, 2, 0, 0]])
        for other in (q, tuple(q), np.array(q)[::1], np.array([q, q]).T[:, 0]):
            dq = tactus.Controller(scene).update(other, [[1.0, 2, 0, 0]])
            self.assertTrue(np.array_equal(dq, expected))


class Places(unittest.TestCase):
    def test_begin_where_the_arm_stands(self):
        scene = load("free_motion")
        q = scene.q_start + 1e-3
        controller = tactus.Controller(scene, q)
        controller.update(q)
        self.assertTrue(np.array_equal(controller.record()["q"], q))

    def test_of_modules_are_those_of_a_planar_arm(self):
        """Two links in a plane, by hand."""
        scene = load("robots/planar2_contact")
        controller = tactus.Controller(scene)
        for a, b in np.random.default_rng(1).uniform(-2.5, 2.5, (50, 2)):
            pose = controller.module_poses([a, b])[0]
            elbow = np.array([0.5 * np.cos(a), 0.5 * np.sin(a), 0.5])
            on_link = pose[:3, 3] - elbow
            along = np.array([np.cos(a + b), np.sin(a + b), 0])
            self.assertLess(np.abs(np.cross(on_link, along)).max(), 1e-12)
            self.assertLess(np.abs(pose[:3, :3] @ pose[:3, :3].T - np.eye(3)).max(), 1e-12)
            self.assertLess(np.abs(pose[:3, 0] - along).max(), 1e-12)
            self.assertEqual(list(pose[3]), [0, 0, 0, 1])


if __name__ == "__main__":
    unittest.main()
