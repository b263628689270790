#!/usr/bin/env python3
"""Whoever simulates lets other threads of Python go on. No times: a thread that keeps the interpreter's
lock is given no other chance.

usage: threads_test.py FOLDER TACTUS"""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

from common import FOLDER, SCENES, program, tactus

NEVER_S = 1e4  # nobody is made to hand the lock over
DAEMONS = """
import sys, threading
sys.path.insert(0, sys.argv[1])
import tactus
scene = tactus.Scene(sys.argv[2], set={"simulation.duration_s": float(sys.argv[3])})
begun = threading.Semaphore(0)
def work():
    begun.release()
    while True:
        tactus.simulate(scene)
for _ in range(4):
    threading.Thread(target=work, daemon=True).start()
for _ in range(4):
    begun.acquire()
class Late:  # gives the threads time to want the lock, once Python ends
    def __del__(self, sleep=__import__("time").sleep):
        sleep(0.2)
late = Late()
"""


class Threads(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = tactus.Scene(SCENES / "scenario2_estimated.yaml")
        cls.scratch = tempfile.TemporaryDirectory()
        program("simulate", SCENES / "scenario2_estimated.yaml", "-o", cls.scratch.name)
        cls.log = pathlib.Path(cls.scratch.name) / "scenario2_estimated/run.ulg"

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def goes_on_during(self, work):
        """Whether this thread runs while another one is between beginning and end of its work."""
        begun, over, errors = [], [], []

        def other():
            begun.append(True)
            try:
                work()
            except Exception as error:  # noqa: BLE001
                errors.append(error)
            over.append(True)

        before = sys.getswitchinterval()
        sys.setswitchinterval(NEVER_S)
        try:
            thread = threading.Thread(target=other)
            thread.start()  # waits for it to have begun, and then until it gives the lock away
            count = 0
            while not over:
                if begun:
                    count += 1
                if count > 1000:
                    break
            was_within = bool(begun) and not over
            thread.join()
        finally:
            sys.setswitchinterval(before)
        self.assertEqual(errors, [])
        return was_within and count > 1000

    def test_go_on_while_another_one_works(self):
        for name, work in (("simulate", lambda: tactus.simulate(self.scene)),
                           ("check", self.scene.check),
                           ("load", lambda: tactus.Scene(SCENES / "scenario2_estimated.yaml")),
                           ("read", lambda: tactus.read_log(self.log)),
                           ("replay", lambda: tactus.replay(self.log))):
            with self.subTest(name):
                # Short work may be over before a busy machine has run this thread at all.
                self.assertTrue(any(self.goes_on_during(work) for _ in range(100)))

    def test_do_not_go_on_while_another_one_keeps_the_lock(self):
        """The test can fail."""
        self.assertFalse(any(self.goes_on_during(lambda: sum(range(300_000))) for _ in range(100)))

    def test_simulate_the_same_beside_each_other(self):
        alone = tactus.simulate(self.scene)["dq"].tobytes()
        results = []
        threads = [threading.Thread(target=lambda: results.append(tactus.simulate(self.scene)))
                   for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual([run["dq"].tobytes() for run in results], [alone] * 4)

    def test_of_daemons_end_with_the_program(self):
        """Of short runs, which want the lock back at their end, and of long ones, which look for signals."""
        for duration_s in (0.05, 3600):
            done = subprocess.run([sys.executable, "-c", DAEMONS, FOLDER, SCENES / "free_motion.yaml",
                                   str(duration_s)], text=True, capture_output=True, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (0, ""), duration_s)

    def test_are_ended_by_a_signal(self):
        endless = tactus.Scene(SCENES / "free_motion.yaml", set={"simulation.duration_s": 3600})
        timer = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            tactus.simulate(endless)
        timer.join()


if __name__ == "__main__":
    unittest.main()
