#!/usr/bin/env python3
"""What the panel's server answers, and where it listens.

usage: panel_answers_test.py TACTUS_PANEL VIRTUAL_DAEMON
"""
import json
import os
import pathlib
import re
import socket
import stat
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from panel_rig import PATIENCE_S, POST, Rig, nobody, wait_for  # noqa: E402

DAEMON = pathlib.Path(sys.argv.pop(2)).resolve()
PANEL = pathlib.Path(sys.argv.pop(1)).resolve()
SET = {"do": "set", "values": {"controller.damping": "0.55"}}


class Answers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rig = Rig(PANEL, DAEMON)
        cls.addClassCleanup(cls.rig.close)
        cls.rig.start_daemon(POST)
        cls.rig.start_panel()

    def test_page_with_all_that_it_names(self):
        _, headers, page = self.rig.ask("GET", "/")
        self.assertIn("default-src 'self'", headers["Content-Security-Policy"])
        for name, value in (("X-Content-Type-Options", "nosniff"), ("Cache-Control", "no-store"),
                            ("X-Frame-Options", "DENY"), ("Referrer-Policy", "no-referrer")):
            self.assertEqual(headers[name], value)
        named = set(re.findall(r'(?:src|href)="([^"]+)"', page))
        self.assertGreater(len(named), 3)
        for path in named:
            self.assertTrue(path.startswith("/") and not path.startswith("//"), path)
            self.assertEqual(self.rig.ask("GET", path)[0], 200, path)

    def test_events_hold_the_state_and_what_comes(self):
        events = self.rig.events()
        first = next(events)
        self.assertTrue(first["begins"])
        self.assertEqual(first["state"]["status"]["mode"], "running")
        self.assertEqual(first["state"]["links"], ["link4"])
        times = []
        while len(times) < 20:
            force = next(events).get("force")
            times += force["t"] if force else []
        self.assertEqual(times, sorted(set(times)))
        events.close()

    def test_many_pages_leave_room_for_others(self):
        # That others have gone the server sees with the next event.
        streams = [wait_for("a place", self.rig.open_events) for _ in range(8)]
        self.assertIsNone(self.rig.open_events())
        self.assertEqual(self.rig.ask("GET", "/")[0], 200)
        for stream in streams:
            stream.close()
        wait_for("a place is free again", self.rig.open_events).close()

    def test_check_says_what_set_then_does(self):
        def check(values):
            return json.loads(self.rig.ask("POST", "/api/check", {"values": values})[2])
        for values in ({"controller.damping": "0.55"}, {"controller.time_constant_s": "0.01"},
                       {"controller.damping": "0"}, {"controller.contact_threshold_N": "0.2"},
                       {"task.components": "[x]"}, {"stiffness.assumed_N_per_m": "4000"}):  # fmt: skip
            checked = check(values)
            status, answer = self.rig.do({"do": "set", "values": values})
            self.assertEqual(checked["refused"] == "", status == 200, (checked, answer))
            if checked["refused"]:
                self.assertEqual(checked["refused"], answer["error"])
            wait_for("kept or on trial", lambda: self.rig.show()["state"] in ("kept", "on_trial", "waiting"))

    def test_a_peak_of_a_single_cycle_is_not_lost(self):
        # What is felt at the touch: as large in the events as in the log.
        self.rig.do({"do": "move", "relative": True, "to_m": [0, 0.35, 0]})
        events, most = self.rig.events(), 0.0
        for event in events:
            for module in event.get("force", {}).get("high", []):
                most = max([most, *module])
            over = event.get("contacts", []) + event.get("lasting", [])
            if over and over[-1]["end_s"] > over[-1]["start_s"] + 0.5:
                self.assertAlmostEqual(most, over[-1]["peak_force_N"], delta=6e-5)
                self.assertAlmostEqual(max(over[-1]["trace"]["high"][0]), most, delta=1e-9)
                break
        events.close()
        self.rig.do({"do": "hold"})


class Places(unittest.TestCase):
    def setUp(self):
        self.rig = Rig(PANEL, DAEMON)
        self.addCleanup(self.rig.close)

    def test_listens_on_this_machine_alone(self):
        self.rig.start_panel()
        with open("/proc/net/tcp") as table, open("/proc/net/tcp6") as table6:
            listening = [line.split()[1] for line in [*table, *table6] if line.split()[3] == "0A"]
        ours = [place for place in listening if place.endswith(f":{self.rig.port:04X}")]
        self.assertEqual(ours, [f"0100007F:{self.rig.port:04X}"])

    def test_a_port_that_is_taken_is_refused(self):
        self.rig.start_panel()
        done = subprocess.run([PANEL, "--port", str(self.rig.port)], capture_output=True, text=True,
                              env=self.rig.environment(), timeout=PATIENCE_S)  # fmt: skip
        self.assertEqual((done.returncode, done.stderr.count("\n")), (3, 1), done.stderr)

    def test_socket_is_the_users_own(self):
        path = self.rig.folder / "panel.sock"
        for _ in range(2):  # also where one was left behind
            self.rig.start_panel("--socket", path)
            self.rig.panel.stdout.readline()
            self.assertEqual(stat.S_IMODE(os.stat(path).st_mode), 0o600)
            connection = socket.socket(socket.AF_UNIX)
            connection.connect(str(path))
            connection.sendall(b"GET / HTTP/1.1\r\nHost: localhost:8470\r\n\r\n")
            self.assertIn(b" 200 ", connection.recv(65536))
            connection.close()
            self.rig.panel.kill()
            self.rig.panel.communicate()
        self.rig.start_panel("--socket", os.path.relpath(path))
        self.assertTrue(os.path.samefile(self.rig.address.split()[0], path), self.rig.address)
        self.assertTrue(self.rig.address.startswith("/"), "for another folder")
        self.rig.stop_panel()
        self.assertFalse(path.exists())

    def test_a_file_in_the_way_stays(self):
        path = self.rig.folder / "file"
        path.write_text("mine")
        done = subprocess.run([PANEL, "--socket", path], capture_output=True, text=True, timeout=PATIENCE_S,
                              env=self.rig.environment())  # fmt: skip
        self.assertEqual((done.returncode, path.read_text()), (3, "mine"), done.stderr)

    def test_a_socket_without_a_name_is_no_port(self):
        done = subprocess.run([PANEL, "--socket", ""], capture_output=True, text=True, timeout=PATIENCE_S,
                              env=self.rig.environment())  # fmt: skip
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)

    def test_a_socket_that_is_in_use_stays(self):
        for kind in (socket.SOCK_SEQPACKET, socket.SOCK_STREAM):
            path = self.rig.folder / f"other{kind}"
            with socket.socket(socket.AF_UNIX, kind) as other:
                other.bind(str(path))
                other.listen()  # and says nothing
                before = os.stat(path).st_ino
                done = subprocess.run([PANEL, "--socket", path], capture_output=True, text=True,
                                      timeout=PATIENCE_S, env=self.rig.environment())  # fmt: skip
                self.assertEqual((done.returncode, os.stat(path).st_ino), (3, before), done.stderr)

    def test_a_socket_of_who_came_after_stays(self):
        path = self.rig.folder / "panel.sock"
        self.rig.start_panel("--socket", path)
        path.rename(self.rig.folder / "moved")
        path.write_text("another")
        self.rig.stop_panel()
        self.assertEqual(path.read_text(), "another")

    def test_a_log_that_has_stopped_is_not_taken_for_live(self):
        self.rig.start_daemon(POST)
        self.rig.start_panel()
        self.rig.do({"do": "move", "relative": True, "to_m": [0, 0.35, 0]})
        events = self.rig.events()
        wait_for("a contact", lambda: next(events).get("lasting"))
        status = json.loads((self.rig.runtime / "status.json").read_text())
        self.rig.stop_daemon(is_killed=True)
        status["log"] |= {"state": "stopped", "reason": "disk full"}
        status["monotonic_s"] = time.monotonic()
        (self.rig.runtime / "status.json").write_text(json.dumps(status))
        lasting = None

        def problem():
            nonlocal lasting
            event = next(events)
            lasting = event.get("lasting", lasting)
            return (event.get("state") or {}).get("log_problem")
        self.assertEqual(wait_for("a word", problem), "the daemon's log has stopped: disk full")
        self.assertEqual(lasting, [])
        events.close()

    def test_a_status_that_may_not_be_read_is_no_daemon_that_is_missing(self):
        self.rig.folder.chmod(0o755)
        status = self.rig.runtime / "status.json"
        status.write_text(json.dumps({"monotonic_s": time.monotonic()}))
        status.chmod(0)
        self.rig.start_panel(**nobody())
        events = self.rig.events()
        state = wait_for("a state", lambda: next(events).get("state"))
        events.close()
        self.assertEqual((state["is_there"], state["problem"]),
                         (True, "its status may not be read; it is for root and the group tactus"))

    def test_a_status_of_other_types_ends_nothing(self):
        status = {"pid": "x", "mode": {}, "log": 3, "scene": None}
        self.rig.start_panel()
        events = self.rig.events()
        for monotonic_s in (time.monotonic(), [], "now"):
            (self.rig.runtime / "status.json").write_text(json.dumps(status | {"monotonic_s": monotonic_s}))
            time.sleep(0.3)
        (self.rig.runtime / "status.json").write_text(json.dumps(status | {"monotonic_s": time.monotonic()}))
        wait_for("a state", lambda: (next(events).get("state") or {}).get("is_there"))
        events.close()
        self.assertIsNone(self.rig.panel.poll())

    def test_a_daemon_of_another_version_is_named(self):
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as daemon:
            daemon.bind(str(self.rig.runtime / "control"))
            daemon.listen()
            self.rig.start_panel()
            events = self.rig.events()
            connection, _ = daemon.accept()
            connection.recv(65536)
            connection.send(b'{"done": true, "task": 1}')
            wait_for("its problem", lambda: "another version" in
                     (next(events).get("state") or {}).get("control_problem", ""))  # fmt: skip
            events.close()
            self.assertIsNone(self.rig.panel.poll())
            connection.close()

    def test_without_a_daemon_it_says_so(self):
        self.rig.start_panel()
        events = self.rig.events()
        wait_for("a state", lambda: (next(events).get("state") or {}).get("is_there") is False)
        events.close()
        self.assertEqual(self.rig.do(SET)[0], 503)
        self.assertEqual(self.rig.ask("POST", "/api/check", {"values": {}})[0], 503)


if __name__ == "__main__":
    unittest.main()
