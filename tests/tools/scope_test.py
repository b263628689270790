#!/usr/bin/env python3
"""`tactus scope` while a log grows: each trigger once it is complete, --single that ends with the first
that comes, --auto without any, the log of a daemon by its status; and what it refuses.

usage: scope_test.py TACTUS
"""
import json
import os
import pathlib
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
SCENE = pathlib.Path(__file__).resolve().parents[2] / "config/scenes/whole_arm/crops9_skin_two_links.yaml"
FIRST, SECOND = "force_N[1] > 1.2", "force_N[2] > 1.2"  # at 5.6 s and 7.2 s
PIECE = 60007  # anywhere, also within a cycle


class Scope(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        folder = pathlib.Path(cls.scratch.name)
        subprocess.run([TACTUS, "simulate", SCENE, "--set", "simulation.duration_s=9", "-o", folder],
                       check=True, capture_output=True)  # fmt: skip
        cls.log = next(folder.glob("*/run.ulg"))
        cls.live = folder / "live"
        cls.live.mkdir()
        cls.shown = cls.run_live()

    @classmethod
    def start(cls, *options, **environment):
        program = subprocess.Popen([TACTUS, "scope", "--post", "0.5", *options], text=True,
                                   stdout=subprocess.PIPE, env=os.environ | environment)  # fmt: skip
        cls.addClassCleanup(program.kill)
        return program

    @classmethod
    def tell_that_it_runs(cls):
        """As a daemon does, until the run has ended."""
        while not (cls.live / "summary.json").exists():
            (cls.live / "next").write_text(
                json.dumps({"monotonic_s": time.monotonic(), "log": {"folder": str(cls.live)}}))  # fmt: skip
            (cls.live / "next").rename(cls.live / "status.json")
            time.sleep(0.5)

    @classmethod
    def run_live(cls):
        """What each prints; the first contact is over when they begin."""
        path = cls.live / "run.ulg"
        content = cls.log.read_bytes()
        at = int(0.72 * len(content))
        path.write_bytes(content[:at])
        telling = threading.Thread(target=cls.tell_that_it_runs, daemon=True)
        telling.start()
        while not (cls.live / "status.json").exists():
            time.sleep(0.01)
        followed = ["--follow", "--json", path]
        programs = {
            "normal": cls.start("--trigger", SECOND, *followed),
            "both": cls.start("--trigger", FIRST, *followed),
            "late": cls.start("--single", "--trigger", FIRST, *followed),
            "auto": cls.start("--auto", "--trigger", "force_N > 1e6", *followed),
            "fires": cls.start("--auto", "--pre", "0", "--trigger", SECOND, *followed),
            "daemon": cls.start("--trigger", SECOND, "--json", RUNTIME_DIRECTORY=str(cls.live)),
        }
        single = cls.start("--single", "--trigger", SECOND, "-o", cls.live / "page.html", *followed)
        for program in (single, *programs.values()):
            wait_until_read(program, path)
        with open(path, "ab") as file:
            while at < len(content):
                file.write(content[at:at + PIECE])
                file.flush()
                at += PIECE
                time.sleep(0.02)
        # It ends by itself, while the run goes on.
        shown = {"single": single.communicate(timeout=60)[0]}
        assert single.returncode == 0
        cls.is_late_waiting = programs["late"].poll() is None
        (cls.live / "summary.json").write_text("{}")
        for name, program in programs.items():
            shown[name] = program.communicate(timeout=60)[0]
            assert program.returncode == 0, name
        telling.join()
        return {name: [json.loads(line) for line in text.splitlines()] for name, text in shown.items()}

    def whole(self, trigger, *options):
        done = subprocess.run([TACTUS, "scope", "--post", "0.5", "--trigger", trigger, "--json", *options, self.log],
                              check=True, capture_output=True, text=True)  # fmt: skip
        return json.loads(done.stdout)

    def test_shows_what_the_whole_log_does(self):
        expected = self.whole(SECOND)
        self.assertEqual(len(expected), 1)
        self.assertEqual(self.shown["normal"], expected)
        self.assertEqual(self.shown["daemon"], expected)
        self.assertEqual(self.shown["both"], self.whole(FIRST), "one that was there already, once")

    def test_single_ends_with_the_first_that_comes(self):
        self.assertEqual(self.shown["single"], self.whole(SECOND))
        self.assertEqual(self.shown["late"], [], "what was before does not count")
        self.assertTrue(self.is_late_waiting)
        self.assertIn("<svg", (self.live / "page.html").read_text())

    def test_auto_shows_what_there_is(self):
        self.assertGreater(len(self.shown["auto"]), 1)
        for trace in self.shown["auto"]:
            self.assertFalse(trace["is_triggered"])
            self.assertEqual(trace["force"]["t_s"][-1], 0.0)

    def test_auto_shows_the_trigger_too(self):
        """Pictures are as long as what comes behind a trigger: one would fall into it."""
        shown = self.shown["fires"]
        expected = self.whole(SECOND, "--pre", "0")
        self.assertEqual([trace for trace in shown if trace["is_triggered"]], expected)
        self.assertEqual(len(expected), 1)
        self.assertGreater(len(shown), 2)
        times = [trace["trigger_s"] for trace in shown]
        self.assertEqual(times, sorted(set(times)))
        at = expected[0]["trigger_s"]
        self.assertFalse([time_s for time_s in times if at < time_s < at + 0.5])

    def test_page_is_well_formed(self):
        page = (self.live / "page.html").read_text()
        for svg in page.split("<svg")[1:]:
            xml.etree.ElementTree.fromstring("<svg" + svg.split("</svg>")[0] + "</svg>")

    def test_what_it_cannot_do_is_one_line(self):
        missing = str(self.live / "nowhere")
        for arguments, code, words in (
                (["--trigger", "force > 1", self.log], 1, "--trigger:1:1: 'force > 1': 'force' is no field"),
                (["--trigger", "force_N >", self.log], 1, "--trigger:1:10:"),
                ([self.live / "none.ulg"], 1, "none.ulg"),
                (["-o", self.log, self.log], 1, "is the input itself"),
                (["-o", missing + "/x.html", self.log], 1, "x.html"),
                (["-o", "-", self.log], 1, "standard output has the drawing"),
                (["-o", self.live / "no.html", "--trigger", "force_N > 1e6", self.log], 1, "is not written"),
                ([], 3, "no daemon is running")):
            done = subprocess.run([TACTUS, "scope", *arguments], capture_output=True, text=True,
                                  env=os.environ | {"RUNTIME_DIRECTORY": missing})  # fmt: skip
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn(words, done.stderr)
        self.assertFalse(list(self.live.glob("no.html*")))
        done = subprocess.run([TACTUS, "contacts", "--json"], capture_output=True, text=True,
                              env=os.environ | {"RUNTIME_DIRECTORY": "/" + 300 * "a"})  # fmt: skip
        self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout.count("\n")), (3, 1, 1))
        self.assertRegex(done.stderr, "^/a+/status.json: File name too long$")
        self.assertEqual(json.loads(done.stdout)["error"] + "\n", done.stderr)
        for arguments in (["--single", "--auto"], ["--keep", "0"], ["--pre", "-1"], ["--post", "nan"],
                          ["--pre", "nan"], ["--hysteresis", "nan"], ["--holdoff", "nan"],
                          ["--single", "--normal"], ["--normal", "--auto"], ["--hysteresis", "-1"]):  # fmt: skip
            done = subprocess.run([TACTUS, "scope", *arguments, self.log], capture_output=True)
            self.assertEqual(done.returncode, 2, arguments)


unittest.main()
