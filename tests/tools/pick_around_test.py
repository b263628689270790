#!/usr/bin/env python3
"""The example of a planner: it finds a way round a post that holds the arm off, and says in one line
what it cannot do.

usage: pick_around_test.py VIRTUAL_DAEMON
"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

DAEMON = pathlib.Path(sys.argv.pop(1)).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[2]
POST = ("simulation.obstacles=[{post: {foot_m: [0.70771, -0.08, 0], axis: [0, 0, 1], "
        "height_m: 0.62, radius_m: 0.01}, stiffness_N_per_m: 7000}]")  # fmt: skip

sys.path.insert(0, str(ROOT / "examples"))
import pick_around  # noqa: E402


def pick(folder, *target, python=()):
    return subprocess.run([sys.executable, *python, ROOT / "examples/pick_around.py", *target],
                          env=os.environ | {"RUNTIME_DIRECTORY": folder}, text=True,
                          capture_output=True, timeout=300)  # fmt: skip


class PickAround(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def start(self, *settings, scene="commands.yaml"):
        if scene == "commands.yaml":
            settings = ("task.commands={give_up_after_s: 2}", *settings)
        daemon = subprocess.Popen([DAEMON, ROOT / "config/scenes" / scene, *settings],
                                  env=os.environ | {"RUNTIME_DIRECTORY": self.folder}, text=True,
                                  stdout=subprocess.PIPE)  # fmt: skip
        self.addCleanup(daemon.communicate)
        self.addCleanup(daemon.terminate)
        self.assertEqual(daemon.stdout.readline(), "running\n")

    def test_goes_straight_on_where_nothing_is(self):
        self.start("simulation.obstacles=[]")
        done = pick(self.folder, "0.9426", "0.6", "0.2421")
        self.assertEqual((done.returncode, done.stdout), (0, "straight on: arrived\n"), done)

    def test_finds_a_way_round_a_post(self):
        self.start(POST)
        done = pick(self.folder, "0.9426", "0.75", "0.2421")
        self.assertEqual(done.returncode, 0, done)
        self.assertIn("straight on: given_up\n", done.stdout)
        self.assertRegex(done.stdout, r"held off by [45]\.\d N on link4 at \[0\.7")
        self.assertIn("over it: arrived\n", done.stdout)

    def test_learns_from_a_target_given_up_between_two_looks(self):
        self.start(POST)
        seldom = ("import runpy, sys, time; sleep = time.sleep; time.sleep = lambda s: sleep(1);"
                  "sys.argv.pop(0); runpy.run_path(sys.argv[0], run_name='__main__')")  # fmt: skip
        done = pick(self.folder, "0.9426", "0.75", "0.2421", python=("-c", seldom))
        self.assertIn("held off by", done.stdout, done)
        self.assertEqual(done.returncode, 0, done)

    def test_says_what_is_out_of_reach(self):
        self.start("simulation.obstacles=[]")
        done = pick(self.folder, "9", "0.7", "0.2")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "^pick_around: waypoint 1: out of reach: .*\n$")

    def test_says_what_is_no_target(self):
        for target in (("x", "0", "0"), ("nan", "0", "0"), ("0.9", "0.4"), ("0.9", "0.4", "0.2", "0.1")):
            done = pick(self.folder, *target)
            self.assertEqual((done.returncode, done.stdout), (1, ""), done)
            self.assertIn("usage: pick_around.py X Y Z", done.stderr)
            self.assertNotIn("Traceback", done.stderr)

    def test_says_that_the_task_is_another_one(self):
        self.start("simulation.obstacles=[]", scene="free_motion.yaml")
        done = pick(self.folder, "0.9", "0.7", "0.2")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "^pick_around: the scene's task is a trajectory, .*\n$")

    def test_holds_the_arm_where_it_is_interrupted(self):
        self.start("simulation.obstacles=[]", "task.commands.max_speed_m_per_s=0.0002")
        picking = subprocess.Popen([sys.executable, ROOT / "examples/pick_around.py", "0.9426", "0.6", "0.2421"],
                                   env=os.environ | {"RUNTIME_DIRECTORY": self.folder}, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)  # fmt: skip
        arm = pick_around.Arm(os.path.join(self.folder, "control"))
        self.addCleanup(arm.socket.close)
        while arm.tool()["state"] != "moving":
            self.assertIsNone(picking.poll())
            time.sleep(0.01)
        picking.send_signal(signal.SIGINT)
        self.assertEqual(picking.communicate(timeout=60), ("held\n", ""))
        self.assertEqual((picking.returncode, arm.tool()["state"]), (1, "holding"))

    def test_says_that_there_is_no_daemon(self):
        done = pick(self.folder, "0.9", "0.7", "0.2")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^pick_around: .*\n$")


if __name__ == "__main__":
    unittest.main()
