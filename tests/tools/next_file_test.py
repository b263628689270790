#!/usr/bin/env python3
"""`tactus scope --follow` and `tactus stream` where the log goes on in another file: what that one holds
already when it is opened is not passed over.

usage: next_file_test.py TACTUS
"""
import json
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from followed import wait_until_read  # noqa: E402

TACTUS = pathlib.Path(sys.argv.pop(1)).resolve()
SCENE = pathlib.Path(__file__).resolve().parents[2] / "config/scenes/scenario1_multi_space.yaml"
CYCLES_PER_S = 1000


class Log:
    """A whole one, to be written as two files (docs/log.md: ULog, https://docs.px4.io)."""

    def __init__(self, path):
        self.bytes = path.read_bytes()
        messages, at = [], 16
        while at < len(self.bytes):
            size, kind = struct.unpack_from("<Hc", self.bytes, at)
            messages.append((kind, self.bytes[at:at + 3 + size]))
            at += 3 + size
        data = [content for kind, content in messages if kind == b"D"]
        before = [content for kind, content in messages if kind != b"D"]
        self.flags, self.definitions, self.gains = before[0], before[1:], data[0]
        self.cycles = data[1:]

    def part(self, number, cycles):
        infos = [self.info("run", "the one"), self.info("part", str(number))]
        return b"".join([self.bytes[:16], self.flags, *infos, *self.definitions, self.gains, *cycles])

    @staticmethod
    def info(name, text):
        key = f"char[{len(text)}] {name}".encode()
        content = bytes([len(key)]) + key + text.encode()
        return struct.pack("<Hc", len(content), b"I") + content


class NextFile(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        folder = pathlib.Path(scratch.name)
        subprocess.run([TACTUS, "simulate", SCENE, "-o", folder], check=True, capture_output=True)
        cls.log = Log(next(folder.glob("*/run.ulg")))
        summary = json.loads(next(folder.glob("*/summary.json")).read_text())
        cls.touch = round(CYCLES_PER_S * summary["contacts"][0]["start_s"])

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.path = pathlib.Path(scratch.name) / "run.ulg"

    def start(self, cycles, *arguments):
        """In front of a log of so many cycles."""
        self.path.write_bytes(self.log.part(0, self.log.cycles[:cycles]))
        program = subprocess.Popen([TACTUS, *arguments], stdout=subprocess.PIPE, text=True)
        self.addCleanup(program.kill)
        wait_until_read(program, self.path)
        return program

    def append(self, program, begin, end):
        with open(self.path, "ab") as file:
            file.write(b"".join(self.log.cycles[begin:end]))
        wait_until_read(program, self.path)

    def go_on_in_another(self, begin, end):
        following = self.path.with_name("next")
        following.write_bytes(self.log.part(1, self.log.cycles[begin:end]))
        self.path.rename(self.path.with_name("run.1.ulg"))
        following.rename(self.path)

    def test_scope_shows_what_ends_in_it(self):
        page = self.path.with_name("page.html")
        scope = self.start(self.touch - 500, "scope", self.path, "--follow", "--single", "--post", "1", "-o", page)
        self.append(scope, self.touch - 500, self.touch + 500)
        self.go_on_in_another(self.touch + 500, self.touch + 3000)
        shown, _ = scope.communicate(timeout=60)
        self.assertEqual(scope.returncode, 0)
        self.assertNotEqual(shown, "")
        self.assertIn("<svg", page.read_text())

    def test_stream_sends_what_it_holds(self):
        receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(receiver.close)
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        receiver.bind(("127.0.0.1", 0))
        stream = self.start(1000, "stream", self.path, "--rate", "1000", "--plotjuggler",
                            f"127.0.0.1:{receiver.getsockname()[1]}")  # fmt: skip
        self.go_on_in_another(1000, 1100)
        wait_until_read(stream, self.path)
        self.path.with_name("summary.json").write_text("{}")
        self.assertEqual(stream.wait(60), 0)
        receiver.settimeout(0)
        sent = set()
        try:
            while True:
                sent.add(round(CYCLES_PER_S * json.loads(receiver.recv(65536))["timestamp"]))
        except BlockingIOError:
            pass
        self.assertLessEqual(set(range(1010, 1090)), sent)


if __name__ == "__main__":
    unittest.main()
