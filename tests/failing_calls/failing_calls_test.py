#!/usr/bin/env python3
"""A call of the C library that fails once, at start or end: the program says so in a line and ends with an exit
code of its own, or goes on as if nothing had been. Arguments: tactus, tactusd, the library that makes calls
fail, virtual_daemon. TACTUS_FAILING_CALLS in the environment says how many calls of each kind (0: all), and
TACTUS_FAILING_CALLS_RUNNING how many of those of a running daemon, which takes a second each; few by default. With
--table behind the arguments it prints what each came to, for docs/failing_calls.md.
tactusd ends here where it looks for its buses, unless the machine has them. What comes after that is looked at
where its cycle, log and socket run in virtual time (virtual_daemon): a call fails once while it runs."""
import collections
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = str(ROOT / "config" / "scenes" / "scenario1_null_space.yaml")
TACTUS, TACTUSD, LIBRARY, VIRTUAL = (str(pathlib.Path(sys.argv.pop(1)).resolve()) for _ in range(4))
IS_TABLE = "--table" in sys.argv
MOST = int(os.environ.get("TACTUS_FAILING_CALLS", "12"))
MOST_RUNNING = int(os.environ.get("TACTUS_FAILING_CALLS_RUNNING", "4"))  # a daemon each
CALLS = ["malloc", "open", "read", "write", "close", "fsync", "rename", "mkdir", "stat", "unlink", "mmap",
         "socket", "mlockall"]
RUNS = {"check": [TACTUS, "check", SCENE],
        "simulate": [TACTUS, "simulate", SCENE, "--set", "simulation.duration_s=0.05", "-o", "out"],
        "daemon": [TACTUSD, SCENE, "-o", "out"]}


def run(name, folder, **failure):
    environment = {**os.environ, "LD_PRELOAD": LIBRARY, **failure}
    return subprocess.run(RUNS[name], cwd=folder, env=environment, capture_output=True, text=True,
                          timeout=120, check=False)


def spread(count, most=MOST):
    """Which of so many calls fail: all, or as many as may be, the first and the last among them."""
    if most == 0 or count <= most:
        return list(range(1, count + 1))
    return sorted({1 + i * (count - 1) // (most - 1) for i in range(most)})


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(pathlib.Path(folder).rglob("*")) if path.is_file()}


def trouble_of(done, whole, folder, whole_files):
    """What is wrong with a run in which a call failed, or None."""
    lines = done.stderr.strip().splitlines()
    if done.returncode < 0 or done.returncode > 100:
        return f"crashes ({done.returncode}): {done.stderr[-300:]}"
    if done.returncode != whole.returncode:
        return None if len(lines) in (1, 2) else f"says {len(lines)} lines: {done.stderr[-300:]}"
    made = files(folder)
    if set(made) != set(whole_files) and not lines:
        return f"leaves out {sorted(set(whole_files) - set(made))} and says nothing"
    for path, content in made.items():
        if len(content) < len(whole_files[path]) and path.endswith(".ulg") and not lines:
            return f"cuts {path} off and says nothing"
        if path.endswith(".json"):
            try:
                json.loads(content)
            except ValueError:
                return None if lines else f"cuts {path} off and says nothing"
    return None


def calls_of(command, call, folder):
    """How many there are."""
    path = pathlib.Path(folder) / "count"
    environment = {**os.environ, "LD_PRELOAD": LIBRARY, "FAIL_CALL": call, "FAIL_COUNT": str(path)}
    subprocess.run(command, cwd=folder, env=environment, capture_output=True, timeout=120, check=False)
    return int(path.read_text())


LATE = 160  # allocations before the end, of summary and of the list of system calls


def known_outcome(name, number, count, returncode, said):
    """What libraries do that ask for memory where they may not throw, or do not look whether there was any; None if
    it is none of these. Before a file is read: constants before main(), and CLI11's search for an option, of which
    all programs have done theirs when they tell their version. Later: nlohmann-json 3.11's destructor, while
    simulate makes the summary, when the log is whole; and libseccomp 2.5, while tactusd makes the list of system
    calls of its loop, before it looks for its buses. returncode: None if it did not end."""
    if returncode == -6 and "std::bad_alloc" in said:
        with tempfile.TemporaryDirectory() as folder:
            if number <= calls_of([RUNS[name][0], "--version"], "malloc", folder):
                return "aborts before it has read a file"
        return "aborts with the log written" if name == "simulate" and number > count - LATE else None
    is_filter = name == "daemon" and returncode in (-11, None) and number > count - LATE
    return "ends by a signal, or not at all, before it has its buses" if is_filter else None


RUNNING_CALLS = ["malloc", "open", "write", "close", "rename", "poll", "accept", "send", "recv"]
REQUESTS = [{"do": "show"}, {"do": "set", "values": {"controller.damping": 0.7}}, {"do": "undo"},
            {"do": "move", "to_m": [0, 0.02, 0], "relative": True}, {"do": "hold"}, {"do": "reload"}]
PATIENCE_S = 20


def ask(path, request):
    """The answer; None where the connection ends without one."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as connection:
            connection.settimeout(PATIENCE_S)
            connection.connect(path)
            connection.send(json.dumps(request).encode())
            return json.loads(connection.recv(1 << 18) or b"null")
    except OSError:
        return None


def run_daemon(folder, **failure):
    """A daemon that is asked, twice for all, until it is told to end: (process, answers)."""
    (pathlib.Path(folder) / "log").mkdir()
    shutil.copytree(ROOT / "config", pathlib.Path(folder) / "config")
    environment = {**os.environ, "LD_PRELOAD": LIBRARY, "FAIL_SIGNAL": "1", "RUNTIME_DIRECTORY": folder, **failure}
    process = subprocess.Popen([VIRTUAL, "--log", "log", "20", "config/scenes/commands.yaml"], cwd=folder,
                               env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "running\n"
        process.send_signal(signal.SIGUSR2)
        path = str(pathlib.Path(folder) / "control")
        answers = [ask(path, request) for request in REQUESTS * 2]
        process.terminate()
        _, said = process.communicate(timeout=PATIENCE_S)
        return subprocess.CompletedProcess([], process.returncode, "", said), answers
    finally:
        process.kill()
        process.communicate()


def running_trouble(call, done, answers, folder):
    """What is wrong with a daemon that ran while a call failed, or None. Without memory for what it writes it
    says so and ends, as tactusd does."""
    if done.returncode == 3 and call == "malloc" and "virtual_daemon: std::bad_alloc" in done.stderr:
        return None
    if done.returncode != 0:
        return f"ends ({done.returncode}): {done.stderr[-300:]}"
    lost = [(request, answer and answer.get("error")) for request, answer in zip(REQUESTS * 2, answers)
            if not answer or not answer["done"]]
    if lost and lost[0][0]["do"] == "set" and lost[-1][1] == "undo: nothing was changed before":
        lost.pop()
    if len(lost) > 1:
        return f"does not do {lost}: {done.stderr[-300:]}"
    log = subprocess.run([TACTUS, "replay", str(pathlib.Path(folder) / "log/run.ulg")], capture_output=True,
                         text=True, check=False)
    return f"leaves a log that {log.stderr}" if log.returncode != 0 and "log stopped" not in done.stderr else None


def may_be_a_destructor(call, done):
    """nlohmann-json's destructor again: some allocations in a hundred of a running daemon are its own. Which call
    is the n-th is a matter of time, so what ends the daemon elsewhere does so in the next runs, too."""
    return call == "malloc" and done.returncode == -6 and "std::bad_alloc" in done.stderr


def outcome_of(name, call, number, count, whole, whole_files):
    """What one failing call comes to, and what is wrong with that, or None."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = run(name, folder, FAIL_CALL=call, FAIL_AT=str(number))
        except subprocess.TimeoutExpired:
            done = None
        known = known_outcome(name, number, count, done and done.returncode, done.stderr if done else "") \
            if call == "malloc" else None
        if known or not done:
            return known or "hangs", None if known else "hangs"
        if done.returncode != whole.returncode:
            outcome = f"ends with a line and {done.returncode}"
        else:
            outcome = "as without" if done.stderr == whole.stderr else "the same, or less, with a line"
        return outcome, trouble_of(done, whole, folder, whole_files)


def outcomes(name):
    """(call, how many there are, number of one that failed, what it came to, what is wrong with that) of each."""
    with tempfile.TemporaryDirectory() as folder:
        whole = run(name, folder)
        whole_files = files(folder)
    for call in CALLS:
        with tempfile.TemporaryDirectory() as folder:
            count = calls_of(RUNS[name], call, folder)
        for number in spread(count):
            yield call, count, number, *outcome_of(name, call, number, count, whole, whole_files)


def running_outcome_of(call, number):
    with tempfile.TemporaryDirectory() as folder:
        try:
            done, answers = run_daemon(folder, FAIL_CALL=call, FAIL_AT=str(number))
        except subprocess.TimeoutExpired:
            return "hangs", "hangs"
        if may_be_a_destructor(call, done):
            return "aborts", None
        is_whole = all(answer and answer["done"] for answer in answers)
        outcome = "ends with a line and 3" if done.returncode == 3 else \
            "goes on" if is_whole else "goes on, a request is not done"
        return outcome, running_trouble(call, done, answers, folder)


def running_outcomes():
    """As outcomes(), of a daemon in virtual time that is asked; how many calls there are is a matter of time."""
    for call in RUNNING_CALLS:
        with tempfile.TemporaryDirectory() as folder:
            run_daemon(folder, FAIL_CALL=call, FAIL_COUNT=f"{folder}/count")
            count = int(pathlib.Path(folder, "count").read_text())
        for number in spread(max(1, 3 * count // 4), MOST_RUNNING):
            yield call, count, number, *running_outcome_of(call, number)


def print_table():
    print("| Program | Call | There are | Failed | Comes to |\n|---|---|---|---|---|", flush=True)
    for name in [*RUNS, "running"]:
        rows = {}
        for call, count, _, outcome, trouble in outcomes(name) if name in RUNS else running_outcomes():
            _, seen = rows.setdefault(call, (count, collections.Counter()))
            seen[f"**{trouble}**" if trouble else outcome] += 1
        for call, (count, seen) in rows.items():
            said = "; ".join(f"{' '.join(text.split())}: {times}" for text, times in seen.most_common())
            print(f"| {name} | {call} | {count} | {sum(seen.values())} | {said} |", flush=True)


class FailingCallsTest(unittest.TestCase):
    def look_at(self, name):
        found, looked_at = [], 0
        for call, _, number, _, trouble in outcomes(name):
            looked_at += 1
            if trouble:
                found.append(f"{call} {number}: {name} {trouble}")
        self.assertGreater(looked_at, len(CALLS))
        self.assertEqual(found, [], "\n".join(found))

    def test_check(self):
        self.look_at("check")

    def test_simulate(self):
        self.look_at("simulate")

    def test_daemon(self):
        self.look_at("daemon")

    def look_at_running(self, call, most, **failure):
        """Troubles, and how many calls failed."""
        with tempfile.TemporaryDirectory() as folder:
            done, answers = run_daemon(folder, FAIL_CALL=call, FAIL_COUNT=f"{folder}/count", **failure)
            self.assertIsNone(running_trouble("", done, answers, folder))
            self.assertTrue(all(answer["done"] for answer in answers))
            count = int(pathlib.Path(folder, "count").read_text())
        self.assertGreater(count, 0, call)
        found, failed = [], 0
        for number in most(max(1, 3 * count // 4)):  # how many there are is a matter of time
            for _ in range(3):
                with tempfile.TemporaryDirectory() as folder:
                    try:
                        done, answers = run_daemon(folder, FAIL_CALL=call, FAIL_AT=str(number),
                                                   FAIL_COUNT=f"{folder}/count", **failure)
                    except subprocess.TimeoutExpired:
                        done, trouble = None, "hangs"
                        break
                    trouble = running_trouble(call, done, answers, folder)
                    counted = pathlib.Path(folder, "count")  # not there where it crashed
                    failed += not counted.exists() or int(counted.read_text()) >= number
                if not may_be_a_destructor(call, done):
                    break
            if trouble:
                found.append(f"{call} {number} of {count}: daemon {trouble}")
        self.assertGreater(failed, 0, call)
        return found, failed

    def test_running(self):
        found, failed = [], 0
        for call in RUNNING_CALLS:
            troubles, calls = self.look_at_running(call, lambda count: spread(count, MOST_RUNNING))
            found, failed = found + troubles, failed + calls
        print(f"{failed} failing calls of a running daemon")
        self.assertEqual(found, [], "\n".join(found))

    def test_a_look_without_memory_does_not_end_it(self):
        """The first calls of the thread of the control socket are those of its looks, between requests."""
        found, _ = self.look_at_running("malloc", lambda _: range(1, 5), FAIL_THREADS="1")
        self.assertEqual(found, [], "\n".join(found))

    def test_a_crash_and_a_cut_log_are_seen(self):
        whole = subprocess.CompletedProcess([], 0, "", "")
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("crashes", trouble_of(subprocess.CompletedProcess([], -6, "", ""), whole, folder, {}))
            (pathlib.Path(folder) / "run.ulg").write_bytes(b"U")
            self.assertIn("cuts", trouble_of(whole, whole, folder, {"run.ulg": b"ULog"}))
            self.assertIn("leaves out", trouble_of(whole, whole, folder, {"run.ulg": b"", "a": b""}))


if __name__ == "__main__":
    if IS_TABLE:
        print_table()
    else:
        unittest.main()
