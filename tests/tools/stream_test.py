#!/usr/bin/env python3
"""`tactus stream` while a log grows: what arrives is JSON as PlotJuggler's UDP server documents it (an
object with numbers, the time as `timestamp`), the same numbers as in the CSV, and all that the layout
shows. And `tactus contacts --follow` beside it.

usage: stream_test.py TACTUS
"""
import csv
import json
import math
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import xml.etree.ElementTree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from followed import wait_until_read  # noqa: E402

TACTUS = pathlib.Path(sys.argv.pop(1)).resolve()
CONFIG = pathlib.Path(__file__).resolve().parents[2] / "config"
SCENE = CONFIG / "scenes/whole_arm/crops9_skin_two_links.yaml"


def tactus(*arguments):
    return subprocess.run([TACTUS, *arguments], check=True, capture_output=True, text=True).stdout


class Receiver:
    """All datagrams, as they come: the kernel's buffer does not hold those of seconds."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.2)
        self.datagrams = []
        self.is_over = False
        self.thread = threading.Thread(target=self.receive, daemon=True)
        self.thread.start()

    def receive(self):
        while True:
            is_over = self.is_over
            try:
                self.datagrams.append(self.socket.recv(65536))
            except TimeoutError:
                if is_over:
                    return

    def all(self):
        """Once nobody sends any more."""
        self.is_over = True
        self.thread.join()
        self.socket.close()
        return self.datagrams


def times_of(datagrams):
    return sorted({json.loads(datagram)["timestamp"] for datagram in datagrams})


class Stream(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        folder = pathlib.Path(cls.scratch.name)
        tactus("simulate", SCENE, "--set", "simulation.duration_s=6", "-o", folder)
        cls.log = next(folder.glob("*/run.ulg")).read_bytes()
        tactus("export", next(folder.glob("*/run.ulg")), "-o", folder / "run.csv")
        with open(folder / "run.csv", newline="") as file:
            cls.rows = {row["t_s"]: row for row in csv.DictReader(file)}
        cls.contacts = json.loads(tactus("contacts", next(folder.glob("*/run.ulg")), "--json"))
        cls.live = folder / "live"
        cls.live.mkdir()
        cls.received, cls.followed, cls.often = cls.stream_while_it_grows()

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def stream_while_it_grows(cls):
        path = cls.live / "run.ulg"
        half = len(cls.log) // 2
        path.write_bytes(cls.log[:half])
        receiver, often = Receiver(), Receiver()
        stream, often_stream = (
            subprocess.Popen([TACTUS, "stream", "--plotjuggler", f"127.0.0.1:{to.socket.getsockname()[1]}",
                              "--rate", rate, path])
            for to, rate in ((receiver, "50"), (often, "300")))  # fmt: skip
        follow = subprocess.Popen([TACTUS, "contacts", "--follow", "--json", path], text=True,
                                  stdout=subprocess.PIPE)  # fmt: skip
        for program in (stream, often_stream, follow):
            cls.addClassCleanup(program.kill)
            wait_until_read(program, path)
        with open(path, "ab") as file:
            at = half
            # Cut anywhere, also within a cycle; the first pieces only show that all was read.
            while at < len(cls.log):
                file.write(cls.log[at:at + 40007])
                file.flush()
                at += 40007
                time.sleep(0.02)
        (cls.live / "summary.json").write_text("{}")
        assert (stream.wait(60), often_stream.wait(60)) == (0, 0)
        followed, _ = follow.communicate(timeout=60)
        return receiver.all(), [json.loads(line) for line in followed.splitlines()], often.all()

    def test_is_json_with_finite_numbers_alone(self):
        self.assertGreater(len(self.received), 50)
        times = []
        for datagram in self.received:
            def refuse(word):
                raise ValueError(word)
            record = json.loads(datagram, parse_constant=refuse)
            self.assertLessEqual(len(datagram), 1400)
            if not times or times[-1] != record["timestamp"]:
                times.append(record["timestamp"])
            for name, value in record.items():
                self.assertIsInstance(value, (int, float), name)
                self.assertTrue(math.isfinite(value), name)
        self.assertEqual(times, sorted(set(times)))
        steps = [b - a for a, b in zip(times, times[1:])]
        self.assertAlmostEqual(min(steps), 0.02, places=6)

    def test_rate_holds_in_the_mean(self):
        """300 Hz of 1000: three or four cycles apart, and in the end as many as asked for."""
        times = times_of(self.often)
        self.assertGreater(times[-1] - times[0], 1.0)
        self.assertEqual(len(times), 1 + math.floor(300.0 * (times[-1] - times[0]) + 1e-6))
        steps = {round(1000.0 * (b - a)) for a, b in zip(times, times[1:])}
        self.assertEqual(steps, {3, 4})

    def test_has_the_numbers_of_the_csv(self):
        for datagram in self.received:
            record = json.loads(datagram)
            row = self.rows[min(self.rows, key=lambda t: abs(float(t) - record["timestamp"]))]
            for name, value in record.items():
                if name != "timestamp":
                    self.assertEqual(float(row[name]), value, name)

    def test_has_all_that_the_layout_shows(self):
        layout = xml.etree.ElementTree.parse(CONFIG / "plotjuggler/tactus.xml")
        curves = {curve.get("name") for curve in layout.iter("curve")}
        self.assertGreater(len(curves), 30)
        records = [json.loads(datagram) for datagram in self.received]
        first = {f"/{name}" for record in records for name in record
                 if record["timestamp"] == records[0]["timestamp"]}  # fmt: skip
        self.assertLessEqual(curves, first)

    def test_contacts_are_those_of_the_whole_log(self):
        def start(contact):
            return contact["start_s"]
        self.assertEqual(sorted(self.followed, key=start), self.contacts)

    def test_what_it_cannot_do_is_one_line(self):
        for arguments, word in ((["--plotjuggler", "nowhere.invalid:1"], "nowhere.invalid"),
                                (["--plotjuggler", "127.0.0.1:port"], "HOST:PORT")):
            done = subprocess.run([TACTUS, "stream", *arguments, self.live / "run.ulg"],
                                  capture_output=True, text=True)  # fmt: skip
            self.assertNotEqual(done.returncode, 0)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn(word, done.stderr)
        done = subprocess.run([TACTUS, "stream"], capture_output=True, text=True,
                              env=os.environ | {"RUNTIME_DIRECTORY": self.scratch.name})
        self.assertEqual((done.returncode, done.stderr.count("\n")), (3, 1), done.stderr)


if __name__ == "__main__":
    unittest.main()
