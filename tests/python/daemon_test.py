#!/usr/bin/env python3
"""The client of the daemon, against one in virtual time: gains, orders, status, refusals; and against
sockets that are no daemon.

usage: daemon_test.py FOLDER TACTUS VIRTUAL_DAEMON"""

import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
from common import ROOT, TACTUS, program, tactus

sys.path.insert(0, str(ROOT / "tests/support"))
from panel_rig import Rig, nobody  # noqa: E402

DAEMON = pathlib.Path(sys.argv.pop(1)).resolve()


class Running(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rig = Rig(None, DAEMON)
        cls.addClassCleanup(cls.rig.close)
        cls.rig.start_daemon("simulation.obstacles=[]", pace=20)

    def setUp(self):
        self.daemon = tactus.Daemon(self.rig.runtime / "control")
        self.addCleanup(self.daemon.close)

    def test_changes_gains_and_takes_them_back(self):
        before = self.daemon.show()["ordered"]["controller.damping"]
        answer = self.daemon.set({"controller.damping": before + 0.05})
        self.assertEqual(answer["changes"]["controller.damping"], {"from": before, "to": before + 0.05})
        self.assertNotEqual(answer["state"], "ramping")
        self.assertEqual(answer["ordered"]["controller.damping"], before + 0.05)
        self.assertEqual(self.daemon.diff(),
                         {"controller.damping": {"file": before, "running": before + 0.05}})
        os.environ["RUNTIME_DIRECTORY"] = str(self.rig.runtime)
        self.addCleanup(os.environ.pop, "RUNTIME_DIRECTORY")
        self.assertEqual(json.loads(program("diff", "--json").stdout), self.daemon.diff())
        self.daemon.undo()
        self.assertEqual(self.daemon.diff(), {})
        self.daemon.set({"controller.damping": before + 0.02}, for_s=600)
        self.assertEqual(self.daemon.reload()["ordered"]["controller.damping"], before)

    def test_says_that_another_change_has_come(self):
        os.environ["RUNTIME_DIRECTORY"] = str(self.rig.runtime)
        self.addCleanup(os.environ.pop, "RUNTIME_DIRECTORY")
        before = self.daemon.show()["ordered"]["controller.damping"]

        def takes_back(damping):  # which waits for a contact that never comes
            while self.daemon.show()["ordered"]["controller.damping"] != damping:
                time.sleep(0.01)
            self.daemon.set({"controller.damping": before})

        other = threading.Thread(target=takes_back, args=(before + 0.03,))
        other.start()
        with tactus.Daemon(self.rig.runtime / "control") as waiting, \
                self.assertRaisesRegex(tactus.DaemonError, "^another change has come"):
            waiting.set({"controller.damping": before + 0.03}, wait=True)
        other.join()
        other = threading.Thread(target=takes_back, args=(before + 0.04,))
        other.start()
        ended = program("set", f"controller.damping={before + 0.04}", "--wait")
        other.join()
        self.assertEqual((ended.returncode, ended.stdout), (1, ""))
        self.assertRegex(ended.stderr, "^another change has come[^\n]*\n$")

    def test_does_not_say_that_what_runs_already_waits(self):
        os.environ["RUNTIME_DIRECTORY"] = str(self.rig.runtime)
        self.addCleanup(os.environ.pop, "RUNTIME_DIRECTORY")
        value = self.daemon.show()["ordered"]["controller.damping"]
        for answer in (self.daemon.set({"controller.damping": value}),
                       json.loads(program("set", f"controller.damping={value}", "--json").stdout)):
            self.assertEqual((answer["changes"], answer["state"]), ({}, "on_trial"))
        self.assertEqual(self.daemon.reload()["changes"], {})

    def test_refuses_as_the_daemon_does(self):
        for call in (lambda: self.daemon.set({"controller.damping": -1}),
                     lambda: self.daemon.set({"controller.dampng": 1}),
                     lambda: self.daemon.set({"controller.variant": "null_space"}),
                     lambda: self.daemon.set({"controller.damping": 0.6}, for_s=-1),
                     lambda: self.daemon.move([9, 9, 9]), lambda: self.daemon.move(),
                     lambda: self.daemon.move([1, 2]), lambda: self.daemon.follow([]),
                     lambda: self.daemon.follow([{"nonsense": 1}]),
                     lambda: self.daemon.ask({"do": "dance"}),
                     lambda: self.daemon.ask({})):
            with self.assertRaises(tactus.DaemonError) as refused:
                call()
            self.assertRegex(str(refused.exception), r"^[^\n]{10,}$")
        for call in (lambda: self.daemon.set({"controller.damping": float("nan")}),
                     lambda: self.daemon.set({"controller.damping": object()}),
                     lambda: self.daemon.move(["a", 1, 2]), lambda: self.daemon.move(3),
                     lambda: self.daemon.move("000", relative=True),
                     lambda: self.daemon.move(["0", "0", "0"], relative=True),
                     lambda: self.daemon.move([True, 0, 0], relative=True),
                     lambda: self.daemon.move([0, float("inf"), 0], relative=True),
                     lambda: self.daemon.move([0, 0, 0], relative="no"),
                     lambda: self.daemon.move(to_posture="no"),
                     lambda: self.daemon.stream([0, 0, 0], relative=1),
                     lambda: self.daemon.follow([{"to_m": [0, {1}, 0]}])):
            with self.assertRaises((TypeError, ValueError)):
                call()
        self.assertTrue(self.daemon.show()["done"])  # the connection still works

    def test_takes_numbers_of_numpy(self):
        damping = self.daemon.show()["ordered"]["controller.damping"]
        for one in (np.float32, np.float64, np.int64):
            self.daemon.set({"controller.damping": one(1)})
            self.assertEqual(self.daemon.show()["ordered"]["controller.damping"], 1)
        self.daemon.set({"controller.damping": damping})
        with self.assertRaises(ValueError):
            self.daemon.set({"controller.damping": np.float32("nan")})
        still = np.zeros(3, np.float32)
        self.daemon.move(still, relative=np.bool_(True), speed_m_per_s=np.float32(0.05))
        self.assertEqual(self.daemon.follow([{"to_m": still, "relative": True}], wait=True)["state"], "arrived")

    def test_moves_the_tool(self):
        start = self.daemon.task()["p_BaseTool_m"]
        task = self.daemon.move([0, 0.03, None], relative=True, wait=True)
        self.assertEqual(task["state"], "arrived")
        there = self.daemon.task()["p_BaseTool_m"]
        for axis, moved in enumerate((0, 0.03, 0)):
            self.assertAlmostEqual(there[axis] - start[axis], moved, places=3)
        task = self.daemon.follow([{"to_m": start}, {"to_m": there}, {"to_m": start}], wait=True)
        self.assertEqual((task["state"], task["waiting"]), ("arrived", 0))
        self.daemon.move([0, 0.2, 0], relative=True, speed_m_per_s=0.002)
        self.assertEqual(self.daemon.task()["state"], "moving")
        self.daemon.hold()
        self.assertNotIn(self.daemon.task()["state"], ("arrived", "blocked"))
        self.assertIn(self.daemon.stream(start)["state"], ("moving", "holding", "arrived", "late"))

    def test_answers_each_thread_what_it_asked(self):
        wrong = []

        def ask(request, of_it):
            for _ in range(200):
                answer = self.daemon.ask({"do": request})
                if (of_it in answer) != (request == "show"):
                    wrong.append((request, sorted(answer)))

        threads = [threading.Thread(target=ask, args=(request, "ordered")) for request in ("show", "hold")]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_leads_the_tool_by_the_commands(self):
        os.environ["RUNTIME_DIRECTORY"] = str(self.rig.runtime)
        self.addCleanup(os.environ.pop, "RUNTIME_DIRECTORY")
        waypoints = self.rig.folder / "waypoints.yaml"
        waypoints.write_text("- {to_m: [0, .02, ~], relative: true}\n- {to_m: [+0., -.02, ~], relative: true}\n")
        for command in (("follow", "--wait", waypoints), ("move", "--wait", "--relative", "--to", "-,+.02,-")):
            done = program(*command)
            self.assertEqual((done.returncode, done.stdout), (0, "arrived\n"), done.stderr)
        for numbers in ("[0, .inf, 0]", "[0, 0,1, 0]", "[0, nan, 0]", "[0, '0.1', 0]"):
            waypoints.write_text(f"- {{to_m: {numbers}, relative: true}}\n")
            self.assertEqual(program("follow", waypoints).returncode, 1, numbers)

    def test_says_what_it_does(self):
        status = self.daemon.status()
        self.assertEqual([status[name] for name in ("mode", "fault", "scene")],
                         ["running", "none", "commands"])

    def test_ends_with_its_connection(self):
        with tactus.Daemon(self.rig.runtime / "control") as daemon:
            daemon.show()
        with self.assertRaisesRegex(ValueError, "closed, expected a new"):
            daemon.show()
        daemon.close()


class Led(unittest.TestCase):
    """To a posture that the zones of joint limits keep it from, at first."""

    def setUp(self):
        self.rig = Rig(None, DAEMON)
        self.addCleanup(self.rig.close)
        fraction = "redundancy.joint_limit_avoidance.active_fraction"
        self.wide, self.narrow = (f"{fraction}={value}" for value in (0.6, 0.2))
        scene = self.rig.folder / "config/scenes/home.yaml"
        self.rig.start_daemon(self.wide, "simulation.obstacles=[]", pace=20, scene=scene)
        os.environ["RUNTIME_DIRECTORY"] = str(self.rig.runtime)
        self.addCleanup(os.environ.pop, "RUNTIME_DIRECTORY")

    def test_says_when_joints_come_no_nearer(self):
        away = ("move", "--wait", "--relative", "--to", "-,.1,-")
        home = ("move", "--wait", "--to-posture")
        self.assertEqual(program(*away).returncode, 0)
        done = program(*home)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"^arrived\nnot in the posture: j\d is [\d.e-]+ rad away\n$")
        self.assertEqual(program("set", self.narrow).returncode, 0)
        done = program(*home)
        self.assertEqual((done.returncode, done.stdout), (0, "arrived\nin the posture\n"), done.stderr)


class NoDaemon(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.path = pathlib.Path(scratch.name) / "control"

    def serve(self, answer):
        """One that takes a request, and sends that, or nothing."""
        server = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.addCleanup(server.close)
        server.bind(str(self.path))
        server.listen()
        release = threading.Event()

        def work():
            connection, _ = server.accept()
            connection.recv(1 << 16)
            if answer is not None:
                connection.send(answer)
            release.wait(60)
            connection.close()

        thread = threading.Thread(target=work)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(release.set)

    def test_is_said(self):
        with self.assertRaisesRegex(tactus.RunError, "no daemon is running here"):
            tactus.Daemon(self.path)
        self.path.write_text("no socket")
        with self.assertRaises(tactus.RunError):
            tactus.Daemon(self.path)
        with self.assertRaises(tactus.RunError):
            tactus.Daemon("a" * 500)

    def test_is_seen_by_its_answers(self):
        for answer in (b"", b"{", b"[]", b"3", b"\xff", b'{"do": 1}', b"null"):
            with self.subTest(answer=answer):
                self.serve(answer)
                daemon = tactus.Daemon(self.path)
                with self.assertRaises(tactus.RunError):
                    daemon.show()
                with self.assertRaisesRegex(ValueError, "closed"):
                    daemon.show()
                self.doCleanups()
                self.setUp()

    def test_that_hangs_up_is_told_of(self):
        self.serve(b"")  # as seen by who is cut off
        with self.assertRaisesRegex(tactus.RunError, "ended the connection"):
            tactus.Daemon(self.path).show()

    def test_is_not_asked_for_what_are_no_points(self):
        """Nor for what it would take for others: a masked entry for zero or what stays, keys for numbers."""
        masked = np.ma.array([0.9, 0.4, 0.2], mask=[0, 1, 0])
        self.serve(None)
        with tactus.Daemon(self.path, timeout_s=0.05) as daemon:
            for point in (masked, [0.9, np.ma.masked, 0.2], {0: 0.9, 1: 0.4, 2: 0.2}, {0.9, 0.4, 0.2},
                          {0.9: 0, 0.4: 0, 0.2: 0}.keys()):
                for order in (daemon.move, daemon.stream):
                    with self.subTest(point=point), self.assertRaisesRegex(TypeError, "^to_m: .*, expected "):
                        order(point)
            with self.assertRaisesRegex(TypeError, "expected numbers"):
                daemon.follow([{"to_m": masked}])

    def test_is_not_sent_more_than_a_packet(self):
        """After which the connection is as it was."""
        self.serve(b'{"done": true}')
        with tactus.Daemon(self.path) as daemon:
            with self.assertRaisesRegex(ValueError, r"^a request of \d+ bytes, expected at most 32768$"):
                daemon.follow([{"to_m": [0.9, 0.4, 0.25]}] * 100_000)
            self.assertEqual(daemon.show(), {"done": True})

    def test_that_is_silent_is_not_waited_for(self):
        self.serve(None)
        daemon = tactus.Daemon(self.path, timeout_s=0.05)
        with self.assertRaisesRegex(tactus.RunError, "does not answer"):
            daemon.show()

    def test_answers_nobody_who_was_interrupted(self):
        """Its answer would be taken for that to the next request."""
        self.serve(None)
        daemon = tactus.Daemon(self.path)

        def interrupt(*_):
            raise KeyboardInterrupt

        before = signal.signal(signal.SIGALRM, interrupt)
        self.addCleanup(signal.signal, signal.SIGALRM, before)
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        with self.assertRaises(KeyboardInterrupt):
            daemon.show()
        with self.assertRaisesRegex(ValueError, "closed"):
            daemon.hold()

    def test_is_held_by_a_signal_while_another_request_waits(self):
        """The server answers `show` only once it was told to hold; each gets its own answer."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as server:
            server.bind(str(self.path))
            server.listen()
            thread = threading.Thread(target=self.answer_the_last_first, args=(server,))
            thread.start()
            self.addCleanup(thread.join)
            daemon = tactus.Daemon(self.path)
            held = []
            before = signal.signal(signal.SIGALRM, lambda *_: held.append(daemon.hold()))
            self.addCleanup(signal.signal, signal.SIGALRM, before)
            self.assertEqual(daemon.show()["to"], "show")
            self.assertEqual(held, [{"number": 1, "to": "hold"}])
            self.assertEqual(daemon.ask({"do": "undo"})["to"], "undo")  # by the first connection, which is there still
            daemon.close()

    def answer_the_last_first(self, server):
        def answer(connection, request):
            to = json.loads(request)["do"]
            connection.send(json.dumps({"done": True, "to": to, "task": {"number": 1, "to": to}}).encode())

        first, _ = server.accept()
        shown = first.recv(1 << 16)
        signal.pthread_kill(threading.main_thread().ident, signal.SIGALRM)
        server.settimeout(20)
        try:
            second, _ = server.accept()
        except TimeoutError:  # both by one connection
            first.close()
            return
        answer(second, second.recv(1 << 16))
        self.assertEqual(second.recv(1 << 16), b"")  # it is closed
        second.close()
        answer(first, shown)
        answer(first, first.recv(1 << 16))
        first.close()

    def test_that_may_not_be_looked_at_is_not_taken_for_one_without_a_log(self):
        self.path.parent.chmod(0o755)
        status = self.path.parent / "status.json"
        status.write_text("{}")
        status.chmod(0)
        for command in ("contacts", "scope", "stream", "status"):
            done = subprocess.run([TACTUS, command], text=True, capture_output=True, timeout=60,
                                  env=os.environ | {"RUNTIME_DIRECTORY": str(self.path.parent)}, **nobody())
            self.assertEqual(done.returncode, 3, done)
            self.assertIn("it is for root and the group tactus", done.stderr)

    def test_has_no_status(self):
        self.serve(b"{}")
        daemon = tactus.Daemon(self.path)
        status = self.path.parent / "status.json"
        for text, said in ((None, "No such file"), ("{", "not the status"), ("[]", "not the status"),
                           ("{}", "not the status"), ('{"monotonic_s": "a"}', "not the status"),
                           (json.dumps({"monotonic_s": time.monotonic() - 100}), "no word from"),
                           (json.dumps({"monotonic_s": time.monotonic() + 100}), "of before this comp")):
            if text is not None:
                status.write_text(text)
            with self.subTest(text), self.assertRaisesRegex(tactus.RunError, said):
                daemon.status()
        with self.assertRaises(tactus.RunError):
            daemon.show()


if __name__ == "__main__":
    unittest.main()
