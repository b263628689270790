#!/usr/bin/env python3
"""A study on a Dask cluster: a scheduler and workers that are processes of their own. Ends with 4 where
distributed is not installed.

usage: sweep_dask_test.py FOLDER TACTUS"""

import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest
from unittest import mock

from common import FOLDER
from sweep_common import RUNS, STUDY, Sweeps, runs_in, table_of, without_progress
from tactus._sweep import OtherVersion

from tactus_sweep.pool import PoolError

NO_DASK = 4
ON_WORKER = ["--nthreads", "1", "--no-dashboard", "--no-nanny", "--death-timeout", "30"]


class Cluster(Sweeps):
    def setUp(self):
        super().setUp()
        self.address = self.folder / "scheduler.json"
        self.processes = []
        self.addCleanup(self.end)
        self.dask("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file",
                  self.address)
        self.wait(lambda: self.address.exists() and self.address.read_text().endswith("}"))
        self.scheduler = self.address.read_text().split('"address": "')[1].split('"')[0]

    def dask(self, kind, *arguments, module=FOLDER):
        with open(self.folder / f"{kind}.txt", "ab") as said:
            process = subprocess.Popen(
                ["/usr/bin/python3", "-m", f"distributed.cli.dask_{kind}", *map(str, arguments)], stderr=said,
                stdout=said, cwd=self.folder, env=os.environ | {"PYTHONPATH": str(module or "/nowhere")})
        self.processes.append(process)
        return process

    def worker(self, name, module=FOLDER):
        return self.dask("worker", self.scheduler, "--name", name, "--local-directory", self.folder / name,
                         *ON_WORKER, module=module)

    def end(self):
        for process in self.processes:
            process.kill()
            process.wait()

    def wait(self, is_there):
        for _ in range(1200):
            if is_there():
                return
            time.sleep(0.05)
        self.fail("it did not come in a minute")

    def done(self):
        path = self.folder / "out/results.jsonl"
        return path.read_bytes().count(b"\n") - 1 if path.exists() else 0

    def test_has_the_table_of_one_machine_though_a_worker_dies(self):
        runs = 4 * RUNS  # so that some are left when the worker dies
        study = self.study(STUDY.replace("points: 5", "points: 20"))
        whole = self.whole("whole", "-j", 2, study=study)
        first, _ = self.worker("first"), self.worker("second")
        command = self.command(study, self.folder / "out", "--scheduler", self.scheduler)
        sweep = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.wait(lambda: self.done() >= 5)
        self.assertIsNone(sweep.poll())
        self.assertLess(self.done(), runs)
        first.send_signal(signal.SIGKILL)
        said, errors = sweep.communicate(timeout=120)
        self.assertEqual((sweep.returncode, without_progress(errors)), (0, ""), said)
        self.assertEqual(sorted(runs_in(self.folder / "out")), list(range(runs)))
        self.assertEqual(table_of(self.folder / "out"), table_of(whole))

    def test_says_in_one_line_how_it_ended_early(self):
        """Of what dask is told late, when nobody waits for it, nothing is printed."""
        study = self.study(STUDY.replace("points: 5", "points: 2000"))
        self.worker("first")
        command = self.command(study, self.folder / "out", "--scheduler", self.scheduler)
        for end in (lambda sweep: sweep.send_signal(signal.SIGINT),
                    lambda sweep: sweep.send_signal(signal.SIGTERM),
                    lambda _: self.processes[0].kill()):  # the scheduler
            before = self.done()
            sweep = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            self.wait(lambda: self.done() > before + 5)
            end(sweep)
            said, errors = sweep.communicate(timeout=120)
            self.assertEqual((sweep.returncode, said), (3, ""), errors)
            self.assertRegex(without_progress(errors), r"\A[^\n]*(stopped|is lost); the runs [^\n]*\n\Z")

    def test_refuses_workers_with_another_tactus(self):
        other = self.folder / "other"
        shutil.copytree(FOLDER, other)
        [core] = (other / "tactus").glob("_core.*.so")
        core.write_bytes(core.read_bytes() + b"\0")  # the same to the loader, not to whoever compares
        for name, module, expected in (("of_another_build", other, "tactus .*, build .*"),
                                       ("with_none", None, ".*No module named 'tactus.*")):
            with self.subTest(name=name):
                worker = self.worker(name, module)
                done = self.sweep(self.study(), self.folder / "out", "--scheduler", self.scheduler)
                self.assertEqual((done.returncode, done.stdout, self.done()), (1, "", 0), done.stderr)
                self.assertRegex(done.stderr, rf"\Aworker tcp://[\d.:]+ is refused: {expected}, expected tactus "
                                              r"[\d.]+, build \w+\n\Z")
                worker.kill()
                worker.wait()

    def test_says_where_there_is_no_scheduler(self):
        self.end()
        done = self.sweep(self.study(), self.folder / "out", "--scheduler", self.scheduler)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, rf"\A{self.scheduler}: no Dask scheduler with a worker .*\n\Z")


class Errors(unittest.TestCase):
    """Of a batch, which the runs in it cannot have: theirs are rows already."""

    def setUp(self):
        from tactus_sweep.dask_pool import DaskPool

        self.pool = DaskPool.__new__(DaskPool)
        self.pool.identity = {"version": "1", "build": "2"}
        self.submitted = []
        self.pool.submit = lambda _, numbers, size: self.submitted.append(numbers)

    def take(self, error, numbers):
        future = mock.Mock(status="error", exception=lambda: error)
        self.pool.batches = {future: numbers}
        return self.pool.take(None, future)

    def test_of_a_worker_end_the_sweep_and_are_no_rows(self):
        for error, exit_code, expected in (
                (ModuleNotFoundError("No module named 'tactus'"), 1,
                 "a worker is refused: No module named 'tactus', expected tactus 1, build 2"),
                (OtherVersion("tactus 0"), 1, "a worker is refused: tactus 0, expected tactus 1, build 2"),
                (OSError(24, "Too many open files"), 3, r"a worker cannot compute, OSError: .*Too many open files; the "
                 "runs before are kept, and the same command goes on")):
            for numbers in ([4], [4, 5]):
                with self.subTest(error=error, numbers=numbers), self.assertRaisesRegex(PoolError, expected) as ended:
                    self.take(error, numbers)
                self.assertEqual((ended.exception.exit_code, self.submitted), (exit_code, []))

    def test_by_which_workers_die_are_tried_alone_and_then_a_row(self):
        from distributed import KilledWorker

        killed = KilledWorker("run_batch", mock.Mock(address="tcp://b:1"), 3)
        self.assertEqual(self.take(killed, [4, 5]), [])
        self.assertEqual(self.submitted, [[4], [5]])
        [row] = self.take(killed, [4])
        self.assertEqual((row["run"], row["outcome"]), (4, "failed"))
        self.assertIn("KilledWorker", row["reason"])


if __name__ == "__main__":
    if importlib.util.find_spec("distributed") is None:
        print("distributed is not installed: apt-get install python3-distributed")
        sys.exit(NO_DASK)
    unittest.main()
