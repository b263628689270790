#!/usr/bin/env python3
"""A study that is interrupted, at any byte of its results and in any way, ends with the table of one that
was not; no run is lost, none is there twice.

usage: sweep_interrupted_test.py FOLDER TACTUS"""

import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

from common import TACTUS
from sweep_common import RUNS, SCENE, STUDY, Sweeps, runs_in, table_of, without_progress

from tactus_sweep import judge, results, scenes, table
from tactus_sweep.study import make_plan, read_study

CUTS = 150


class Interrupted(Sweeps):
    @classmethod
    def setUpClass(cls):
        folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.done = folder / "whole"
        (folder / "study.yaml").write_text(STUDY)
        subprocess.run([TACTUS, "sweep", folder / "study.yaml", "-o", cls.done, "-j", "2"], check=True,
                       stdout=subprocess.DEVNULL)
        cls.content = (cls.done / "results.jsonl").read_bytes()

    def setUp(self):
        super().setUp()
        self.study()
        self.out = self.folder / "out"
        self.out.mkdir()
        self.file_ = self.out / "results.jsonl"

    def finish(self, *arguments):
        done = self.sweep(self.folder / "study.yaml", self.out, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.expect_whole()
        return done

    def expect_whole(self):
        self.assertEqual(sorted(runs_in(self.out)), list(range(RUNS)))
        self.assertEqual(table_of(self.out), table_of(self.done))

    def test_at_any_byte(self):
        """What the program does between reading the results and writing the table, with runs whose rows are
        known."""
        study = read_study(self.folder / "study.yaml")
        plan = make_plan(study, scenes.load_files(study))
        header = results.header_of(plan, results.read_line(self.content.splitlines()[0])["tactus"])
        known = [results.read_line(line) for line in self.content.splitlines()[1:]]
        begin = self.content.index(b"\n")
        wanted = table_of(self.done)
        chance = random.Random(6)
        cuts = {0, 1, begin - 1, begin, begin + 1, len(self.content) - 1, len(self.content)}
        cuts |= {chance.randrange(begin) for _ in range(20)}
        cuts |= {chance.randrange(begin, len(self.content)) for _ in range(CUTS)}
        for cut in sorted(cuts):
            self.file_.write_bytes(self.content[:cut])
            kept = results.Results(self.out, header)
            whole = max(self.content[:cut].count(b"\n") - 1, 0)
            self.assertEqual((len(kept.rows), kept.damaged), (whole, 0), cut)
            left = [row for row in known if row["run"] not in kept.rows]
            chance.shuffle(left)
            kept.add(left[:3] + left[:1])
            kept.add(left)
            kept.close()
            self.assertEqual(sorted(runs_in(self.out)), list(range(RUNS)), cut)
            rows = [dict(kept.rows[run]) for run in range(RUNS)]
            judge.judge(study, rows)
            self.assertEqual(table.table_text(study, plan, rows).encode(), wanted, cut)

    def test_at_some_bytes_by_the_program(self):
        for cut in (len(self.content) // 2, len(self.content) - 1):
            self.file_.write_bytes(self.content[:cut])
            self.finish()

    def test_by_signals(self):
        """Twice, each time after some runs more; the results are there before the table is."""
        begun = 0
        for number in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT):
            sweep = subprocess.Popen(self.command(self.folder / "study.yaml", self.out, "-j", 1),
                                     stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            self.wait_for_lines(begun + 10)
            sweep.send_signal(number)
            _, said = sweep.communicate(timeout=60)
            if number == signal.SIGKILL:
                self.assertEqual(sweep.returncode, -number)
            elif sweep.returncode != 0:  # it may have come to its end just now
                self.assertEqual(sweep.returncode, 3)
                self.assertRegex(without_progress(said), r"\ASIG\w+: stopped; the runs so far are kept, and the "
                                                         r"same command goes on\n")
            begun = self.file_.read_bytes().count(b"\n")
        self.finish()

    def test_before_the_first_run(self):
        """While the study is read: out of a pipe into which nobody writes."""
        study = self.folder / "slow.yaml"
        os.mkfifo(study)
        sweep = subprocess.Popen(self.command(study, self.out), stderr=subprocess.PIPE, text=True)
        writer = os.open(study, os.O_WRONLY)  # waits for the reader
        self.addCleanup(os.close, writer)
        sweep.send_signal(signal.SIGINT)
        _, said = sweep.communicate(timeout=60)
        self.assertEqual((sweep.returncode, said.count("\n")), (3, 1), said)
        self.assertIn("SIGINT: stopped", said)

    def test_while_python_starts(self):
        """What comes before Python looks for it waits, and is no traceback then."""
        def interrupt():
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            os.kill(os.getpid(), signal.SIGINT)

        for arguments in ((), ("--json",)):
            done = subprocess.run(self.command(self.folder / "study.yaml", self.out, *arguments), text=True,
                                  capture_output=True, preexec_fn=interrupt, timeout=60)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (3, 1), done.stderr)
            self.assertRegex(done.stderr, r"\ASIGINT: stopped; ")
            self.assertEqual(bool(done.stdout), bool(arguments))
            if arguments:
                self.assertEqual(json.loads(done.stdout), {"done": False, "error": done.stderr.strip()})
        self.assertFalse(self.file_.exists())

    def test_waits_from_the_begin_on(self):
        """Of a tactus beside a program that says what it was started with."""
        tactus, sweep = self.folder / "tactus", self.folder / "tactus-sweep"
        shutil.copy(TACTUS, tactus)
        sweep.write_text("#!/bin/sh\nexec grep SigBlk /proc/self/status\n")
        sweep.chmod(0o755)
        said = subprocess.run([tactus, "sweep", "x"], check=True, capture_output=True, text=True).stdout
        self.assertEqual(int(said.split()[1], 16), 1 << (signal.SIGINT - 1))

    def test_where_nobody_takes_its_answer(self):
        self.file_.write_bytes(self.content)
        for arguments in ((), ("--json",)):
            with open("/dev/full", "w") as full:
                done = subprocess.run(self.command(self.folder / "study.yaml", self.out, *arguments), stdout=full,
                                      stderr=subprocess.PIPE, text=True)
            self.assertEqual((done.returncode, done.stderr), (3, "standard output: cannot be written\n"))
        read, write = os.pipe()
        os.close(read)
        done = subprocess.run(self.command(self.folder / "study.yaml", self.out), stdout=write,
                              stderr=subprocess.PIPE, text=True)
        os.close(write)
        self.assertEqual((done.returncode, done.stderr), (-signal.SIGPIPE, ""))
        self.expect_whole()

    def test_where_its_path_is_no_text(self):
        out = os.fsencode(self.folder) + b"/o\xff"
        os.rename(self.out, out)
        pathlib.Path(os.fsdecode(out), "results.jsonl").write_bytes(self.content)
        for arguments in ((), ("--json",)):
            done = self.sweep(self.folder / "study.yaml", out, *arguments,
                              env={**os.environ, "PYTHONIOENCODING": "utf-8:strict"})
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn("udcff/table.csv", done.stdout)

    def test_without_anybody_to_tell(self):
        done = subprocess.run(self.command(self.folder / "study.yaml", self.out),
                              preexec_fn=lambda: os.closerange(1, 3))
        self.assertEqual(done.returncode, 0)
        self.expect_whole()

    def wait_for_lines(self, count):
        for _ in range(6000):
            if self.file_.exists() and self.file_.read_bytes().count(b"\n") >= min(count, RUNS + 1):
                return
            time.sleep(0.01)
        self.fail("no run is done in a minute")

    def test_by_the_death_of_a_worker(self):
        sweep = subprocess.Popen(self.command(self.folder / "study.yaml", self.out, "-j", 2),
                                 stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.wait_for_lines(5)
        with open(f"/proc/{sweep.pid}/task/{sweep.pid}/children", encoding="ascii") as file:
            workers = file.read().split()
        for worker in workers[:1]:
            os.kill(int(worker), signal.SIGKILL)
        _, said = sweep.communicate(timeout=60)
        self.assertEqual((sweep.returncode, without_progress(said), len(workers)), (0, "", 2))
        self.expect_whole()

    def test_by_a_full_disk(self):
        room = len(self.content) - 5000
        done = self.sweep(self.folder / "study.yaml", self.out, preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_FSIZE, (room, room)))
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, r"\A.*results.jsonl: cannot be written \(.*\); the runs before are kept, and "
                                      r"the same command goes on\n\Z")
        self.assertFalse((self.out / "table.csv").exists())
        kept = runs_in_part(self.file_)
        self.assertGreater(kept, RUNS // 2)
        self.assertIn(f"{RUNS - kept} of them now", self.finish().stdout)

    def test_by_damage(self):
        """Of one byte in each of two lines."""
        lines = self.content.split(b"\n")
        for number in (7, 40):
            at = len(lines[number]) // 2
            lines[number] = lines[number][:at] + bytes([lines[number][at] ^ 4]) + lines[number][at + 1:]
        self.file_.write_bytes(b"\n".join(lines))
        done = self.sweep(self.folder / "study.yaml", self.out)
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"\A.*results.jsonl: 2 damaged lines, their runs are done again\n\Z")
        self.assertEqual(table_of(self.out), table_of(self.done))
        again = self.sweep(self.folder / "study.yaml", self.out)
        self.assertEqual((again.returncode, again.stderr), (0, ""))
        self.assertIn(" 0 of them now", again.stdout)


class Others(Sweeps):
    """Results that are not those of this study."""

    def refuse(self, folder, expected, text=STUDY, exit_code=1):
        before = (folder / "results.jsonl").read_bytes()
        done = self.sweep(self.study(text), folder)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (exit_code, 1), done.stderr)
        self.assertRegex(done.stderr, expected)
        self.assertEqual((folder / "results.jsonl").read_bytes(), before)

    def test_are_refused_with_the_difference(self):
        scene = self.file("scene.yaml", (self.scene_text()))
        text = f"scenes: [{scene}]\nset: {{simulation.duration_s: 0.1}}\ngrid: {{controller.damping: [0.5, 1]}}\n"
        folder = self.whole(study=self.study(text))
        self.refuse(folder, r"of other runs: set: was 'simulation.duration_s=0.1', is 'simulation.duration_s=0.2'",
                    text.replace("0.1", "0.2"))
        self.refuse(folder, r"of other runs: grid: was 'controller.damping=1', is 'controller.damping=2'",
                    text.replace("1]", "2]"))
        self.refuse(folder, r"of other runs: grid: 2 choices, now 3", text.replace("1]", "1, 2]"))
        scene.write_text(self.scene_text().replace("stiffness_N_per_m: 300", "stiffness_N_per_m: 310"))
        self.refuse(folder, r"scene.yaml:15: was '    - .*300.*', is '    - .*310.*'", text)
        scene.write_text(self.scene_text().replace("\ntask:", "\n\ntask:"))
        self.refuse(folder, r"scene.yaml:4: was 'task:', is ''; expected the same study", text)
        scene.write_text(self.scene_text())
        content = (folder / "results.jsonl").read_bytes()
        for name, expected in (("version", r"of another tactus, version 9, this one is "),
                               ("build", r"of another tactus, build 9, this one is ")):
            header = results.read_line(content.split(b"\n")[0])
            header["tactus"][name] = "9"
            (folder / "results.jsonl").write_bytes(results.line_of(header))
            self.refuse(folder, expected, text)
        (folder / "results.jsonl").write_bytes(b"x" + content)
        self.refuse(folder, "no results of a sweep, or damaged", text)
        (folder / "results.jsonl").write_bytes(b"something else")
        self.refuse(folder, "no results of a sweep, expected another folder", text)

    def test_tell_at_once_what_differs_in_a_long_file(self):
        """All lines of it, by blanks alone; a comparison that looks for moved lines takes minutes."""
        lines = [f"  key_{number}: {number}" for number in range(2000)]

        def difference(new):
            return results.file_difference({"a.yaml": "\n".join(lines)}, {"a.yaml": new})

        self.assertEqual(difference("\n".join("  " + line for line in lines)),
                         "a.yaml:1: was '  key_0: 0', is '    key_0: 0'")
        self.assertEqual(difference("\n".join(lines[:-1])), "a.yaml:2000: was '  key_1999: 1999', is nothing")
        self.assertEqual(difference("\n".join([*lines, ""])), "a.yaml:2001: was nothing, is ''")
        self.assertEqual(difference("\r\n".join(lines)), "a.yaml:1: was '  key_0: 0', is '  key_0: 0\r'")

    def scene_text(self):
        free = SCENE.with_name("planar2_free.yaml")
        return SCENE.read_text().replace("planar2_free.yaml", str(free))

    def test_go_on_where_only_the_judgement_changes(self):
        folder = self.whole()
        done = self.sweep(self.study(STUDY.replace("1.38", "1.5") + "objective: tcp_error_max_m\n"), folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("0 of them now", done.stdout)

    def test_of_two_sweeps_at_once(self):
        folder = self.folder / "out"
        first = subprocess.Popen(self.command(self.study(), folder, "-j", 1), stdout=subprocess.DEVNULL)
        while not (folder / "results.jsonl").exists() or b"\n" not in (folder / "results.jsonl").read_bytes():
            time.sleep(0.01)
            self.assertIsNone(first.poll())
        first.send_signal(signal.SIGSTOP)
        try:
            self.refuse(folder, "another sweep writes to it", exit_code=3)
        finally:
            first.send_signal(signal.SIGCONT)
        self.assertEqual(first.wait(timeout=60), 0)


def runs_in_part(path):
    return path.read_bytes().count(b"\n") - 1


if __name__ == "__main__":
    unittest.main()
