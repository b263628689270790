#!/usr/bin/env python3
"""A call of the C library that fails once: the program says so in a line and ends with an exit code of its own, or
goes on as if nothing had been, and the arm comes to rest. Arguments: tactus, tactusd, the library that makes calls
fail, virtual_daemon. Programs that start and end: the n-th call of a function fails. A daemon that runs, in virtual
time (virtual_daemon), while it is asked: which call is the n-th is a matter of time there, so the first of those
fails that come to the function by the same way, the same return addresses.
TACTUS_FAILING_CALLS in the environment says how many calls of each function, or ways to each; 0: all; few by
default. With --table [PROGRAM...] behind the arguments it prints what each came to, for docs/failing_calls.md. What
was found stands in the file TACTUS_FAILING_CALLS_FOUND, if that is given, and the next run goes on there; with
TACTUS_FAILING_CALLS_S nothing new is begun after so many seconds."""
import collections
import pathlib
import subprocess
import sys
import tempfile
import unittest

from failing import NOT_AGAIN, VIRTUAL, place_of
from running import run_daemon, running_outcomes, running_trouble
from saves import save_outcomes
from started import RUNS, outcomes, run, trouble_of

IS_TABLE = "--table" in sys.argv


def print_rows(name, rows):
    """Functions whose calls come to the same share a row."""
    shared = {}
    for call, (calls, those, seen) in rows.items():
        key = call if call == "malloc" else tuple(sorted(seen))
        same = shared.setdefault(key, ([], collections.Counter(), [0] * 2))
        same[0].append(call)
        same[1].update(seen)
        same[2][:] = same[2][0] + calls, same[2][1] + those
    for functions, seen, (calls, those) in shared.values():
        said = "; ".join(f"{' '.join(text.split())}: {times}" for text, times in seen.most_common())
        print(f"| {name} | {', '.join(sorted(functions))} | {calls} | {those} | {sum(seen.values())} | {said} |",
              flush=True)


def print_table(names):
    print("| Program | Function | Calls | To try | Tried | Come to |\n|---|---|---|---|---|---|", flush=True)
    for name in names:
        rows = {}
        them = outcomes(name) if name in RUNS else save_outcomes() if name == "save" else running_outcomes()
        for call, calls, those, number, outcome, trouble in them:
            rows.setdefault(call, (calls, those, collections.Counter()))[2][
                f"**{outcome}**" if trouble else outcome] += 1
            if trouble:
                print(f"{name} {call} {number}: {trouble}", file=sys.stderr, flush=True)
        print_rows(name, rows)


class FailingCallsTest(unittest.TestCase):
    def look_at(self, outcomes_of_all):
        found, looked_at = [], 0
        for call, _, _, number, outcome, trouble in outcomes_of_all:
            looked_at += outcome != NOT_AGAIN
            if trouble:
                found.append(f"{call} {number}: {trouble}")
        self.assertGreater(looked_at, 10)
        self.assertEqual(found, [], "\n".join(found))

    def test_check(self):
        self.look_at(outcomes("check"))

    def test_simulate(self):
        self.look_at(outcomes("simulate"))

    def test_daemon(self):
        self.look_at(outcomes("daemon"))

    def test_a_line_says_what_failed(self):
        for call, number, said in [("socket", 2, "tactusd: can0: cannot open a socket to ask for it: "),
                                   ("pthread_create", 1, "tactusd: starting the thread of the service's watchdog: "),
                                   ("pthread_create", 3, "tactusd: starting the thread of the control socket: ")]:
            with tempfile.TemporaryDirectory() as folder:
                done = run("daemon", folder, FAIL_CALL=call, FAIL_AT=str(number))
                self.assertTrue(done.stderr.startswith(said), done.stderr)
                self.assertEqual(done.returncode, 3)

    def test_running(self):
        self.look_at(running_outcomes(runs=1))

    def test_save(self):
        self.look_at(save_outcomes())

    def test_a_look_without_memory_does_not_end_it(self):
        """The first calls of the thread of the control socket are those of its looks, between requests."""
        for number in range(1, 5):
            with tempfile.TemporaryDirectory() as folder:
                done, lost = run_daemon(folder, "gains", FAIL_CALL="malloc", FAIL_AT=str(number), FAIL_THREADS="1",
                                        FAIL_PLACE=f"{folder}/place")
                self.assertTrue(place_of(folder, VIRTUAL))
                self.assertIsNone(running_trouble(done, lost, folder))

    def test_a_crash_and_a_cut_log_are_seen(self):
        whole = subprocess.CompletedProcess([], 0, "", "")
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("crashes", trouble_of(subprocess.CompletedProcess([], -6, "", ""), whole, folder, {}))
            out = pathlib.Path(folder, "out")
            out.mkdir()
            (out / "run.ulg").write_bytes(b"U")
            self.assertIn("cuts", trouble_of(whole, whole, folder, {"out/run.ulg": b"ULog"}))
            self.assertIn("leaves out", trouble_of(whole, whole, folder, {"out/run.ulg": b"", "out/a": b""}))


if __name__ == "__main__":
    if IS_TABLE:
        print_table(sys.argv[sys.argv.index("--table") + 1:] or [*RUNS, "running", "save"])
    else:
        unittest.main()
