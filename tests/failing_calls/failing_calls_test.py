#!/usr/bin/env python3
"""A call of the C library that fails once: the program says so in a line and ends with an exit code of its own, or
goes on as if nothing had been, and the arm comes to rest. Arguments: tactus, tactusd, the library that makes calls
fail, virtual_daemon. Programs that start and end: the n-th call of a function fails. A daemon that runs, in virtual
time (virtual_daemon), while it is asked: which call is the n-th is a matter of time there, so the first of those
fails that come to the function by the same way, the same return addresses.
TACTUS_FAILING_CALLS in the environment says how many calls of each function, or ways to each; 0: all; few by
default. With --table [PROGRAM...] behind the arguments it prints what each came to, for docs/failing_calls.md."""
import bisect
import collections
import functools
import json
import os
import pathlib
import re
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
MOST = int(os.environ.get("TACTUS_FAILING_CALLS", "4"))
PATIENCE_S = 20
RUNS = {"check": [TACTUS, "check", SCENE],
        "simulate": [TACTUS, "simulate", SCENE, "--set", "simulation.duration_s=0.05", "-o", "out"],
        "daemon": [TACTUSD, "scene.yaml", "-o", "out"]}
REQUESTS = [{"do": "show"}, {"do": "set", "values": {"controller.damping": 0.7}}, {"do": "undo"},
            {"do": "move", "to_m": [0, 0.02, 0], "relative": True}, {"do": "hold"}, {"do": "reload"}]
REST_MS = 2000  # of virtual time


def run(name, folder, **failure):
    """The daemon has buses on which nobody answers, whatever the machine has, and a service manager."""
    pathlib.Path(folder, "scene.yaml").write_text(f"extends: {SCENE}\nreal_time: {{required: false}}\n")
    environment = {**os.environ, "LD_PRELOAD": LIBRARY, "FAIL_BUSES": "1", "RUNTIME_DIRECTORY": folder,
                   "NOTIFY_SOCKET": f"{folder}/notify", "WATCHDOG_USEC": "1000000", **failure}
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(f"{folder}/notify")
        return subprocess.run(RUNS[name], cwd=folder, env=environment, capture_output=True, text=True,
                              timeout=PATIENCE_S, check=False)


def spread(those, most=MOST):
    """Which of them fail: all, or as many as may be, the first and the last among them."""
    if most == 0 or len(those) <= most:
        return list(those)
    return [those[i] for i in sorted({i * (len(those) - 1) // (most - 1) for i in range(most)})]


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(pathlib.Path(folder, "out").rglob("*")) if path.is_file()}


def is_read(log):
    return subprocess.run([TACTUS, "replay", str(log)], capture_output=True, check=False).returncode == 0


def trouble_of(done, whole, folder, whole_files):
    """What is wrong with a run in which a call failed, or None."""
    lines = lines_beyond(done, whole)
    if done.returncode < 0 or done.returncode > 100:
        return f"crashes ({done.returncode}): {done.stderr[-300:]}"
    if done.returncode != whole.returncode:
        return None if len(lines) in (1, 2) else f"says {len(lines)} lines: {done.stderr[-300:]}"
    if lines:
        return None
    if len(done.stdout.splitlines()) != len(whole.stdout.splitlines()):
        return f"says less, and nothing of that: {done.stdout}"
    made = files(folder)
    if set(made) != set(whole_files):
        return f"leaves out {sorted(set(whole_files) - set(made))} and says nothing"
    for path, content in made.items():
        if path.endswith(".ulg") and len(content) < len(whole_files[path]):
            return f"cuts {path} off and says nothing"
        if path.endswith(".json"):
            try:
                json.loads(content)
            except ValueError:
                return f"cuts {path} off and says nothing"
    return None


@functools.lru_cache
def symbols(library):
    """Addresses and names of its functions."""
    listed = []
    for option in ([], ["-D"]):
        said = subprocess.run(["nm", "-nC", "--defined-only", *option, library], capture_output=True, text=True,
                              check=False).stdout
        listed += [(int(at, 16), name) for at, kind, name in re.findall("^([0-9a-f]+) ([A-Za-z]) (.*)$", said, re.M)
                   if kind in "tTwW"]
    return sorted(listed)


def place_of(folder, program):
    """The functions in which the call failed, innermost first; [] if none has failed."""
    names = []
    for line in pathlib.Path(folder, "place").read_text().rstrip("\0").splitlines():
        library, offset = line.rsplit(" ", 1)
        library = program if library == "-" else library
        there = symbols(library)
        at = bisect.bisect_right(there, (int(offset, 16), "~")) - 1
        names.append(f"{pathlib.Path(library).name}: {there[at][1] if at >= 0 else '?'}")
    return names


def known_outcome(returncode, said, place):
    """What libraries do that ask for memory where they may not throw; None if it is none of these. Constants before
    main(), and CLI11's search for an option: before a file is read. And nlohmann-json 3.11's destructor."""
    if returncode != -6 or "std::bad_alloc" not in said:
        return None
    if any("nlohmann" in name and ("~basic_json" in name or "destroy" in name) for name in place):
        return "aborts in the destructor of nlohmann-json"
    if any("_GLOBAL__sub_I" in name or "CLI::" in name for name in place):
        return "aborts before it has read a file"
    return None


def outcome_of(name, call, number, whole, whole_files):
    """What one failing call comes to, and what is wrong with that, or None."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = run(name, folder, FAIL_CALL=call, FAIL_AT=str(number), FAIL_PLACE=f"{folder}/place")
        except subprocess.TimeoutExpired:
            return "hangs", f"hangs in {place_of(folder, RUNS[name][0])}"
        if done.returncode < 0:
            place = place_of(folder, RUNS[name][0])
            known = known_outcome(done.returncode, done.stderr, place)
            made = files(folder)
            is_cut = any(path.endswith(".ulg") and len(made.get(path, b"")) < len(content)
                         for path, content in whole_files.items())
            if known and (name == "check" or "before" in known or not is_cut):
                return known, None
            return "crashes", f"crashes ({done.returncode}) in {place}: {done.stderr[-300:]}"
        return outcome_of_end(done, whole), trouble_of(done, whole, folder, whole_files)


def outcome_of_end(done, whole):
    """The daemon without drives comes to its fault, unless it ends before."""
    if done.returncode != whole.returncode or not has_run(done) and has_run(whole):
        return f"ends with a line and {done.returncode}"
    if done.stderr == whole.stderr:
        return "as without"
    return "goes on with a line" if lines_beyond(done, whole) else "goes on, a message is lost"


def has_run(done):
    return "tactusd: fault: " in done.stderr or "tactusd: off: " in done.stderr


def lines_beyond(done, whole):
    return [line for line in done.stderr.strip().splitlines() if line not in whole.stderr.splitlines()]


def outcomes(name, most=MOST):
    """(function, how many calls there are, the one that failed, what it came to, what is wrong with that) of each."""
    with tempfile.TemporaryDirectory() as folder:
        whole = run(name, folder, FAIL_COUNT=f"{folder}/count")
        whole_files = files(folder)
        counts = [line.split() for line in pathlib.Path(folder, "count").read_text().splitlines()]
    for call, count in counts:
        for number in spread(range(1, int(count) + 1), most):
            yield call, int(count), number, *outcome_of(name, call, number, whole, whole_files)


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
    pathlib.Path(folder, "log").mkdir()
    shutil.copytree(ROOT / "config", pathlib.Path(folder, "config"))
    environment = {**os.environ, "LD_PRELOAD": LIBRARY, "FAIL_SIGNAL": "1", "RUNTIME_DIRECTORY": folder, **failure}
    process = subprocess.Popen([VIRTUAL, "--log", "log", "20", "config/scenes/commands.yaml"], cwd=folder,
                               env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "running\n"
        process.send_signal(signal.SIGUSR2)
        path = str(pathlib.Path(folder, "control"))
        answers = [ask(path, request) for request in REQUESTS * 2]
        process.terminate()
        said, errors = process.communicate(timeout=PATIENCE_S)
        return subprocess.CompletedProcess([], process.returncode, said, errors), answers
    finally:
        process.kill()
        process.communicate()


def running_trouble(done, answers, folder):
    """What is wrong with a daemon that ran while a call failed, or None. Without memory for what it writes, and
    without a summary, it says so and ends, as tactusd does."""
    rests = [re.fullmatch(r"(stopped|aborted): at rest after (\d+) ms", line) for line in done.stdout.splitlines()]
    if not rests or any(not rest or int(rest[2]) > REST_MS for rest in rests):
        return f"does not bring the arm to rest: {done.stdout}{done.stderr[-300:]}"
    place = place_of(folder, VIRTUAL)
    if known_outcome(done.returncode, done.stderr, place):
        return None
    last = (done.stderr.splitlines() or [""])[-1]
    if done.returncode == 3 and re.match("virtual_daemon: (log/summary.json|std::bad_alloc)", last):
        return None
    if done.returncode != 0:
        return f"ends ({done.returncode}) in {place}: {done.stderr[-300:]}"
    lost = [(request, answer and answer.get("error")) for request, answer in zip(REQUESTS * 2, answers)
            if not answer or not answer["done"]]
    if lost and lost[0][0]["do"] == "set" and lost[-1][1] == "undo: nothing was changed before":
        lost.pop()
    if len(lost) > 1:
        return f"does not do {lost} in {place}: {done.stderr[-300:]}"
    if not is_read(f"{folder}/log/run.ulg") and "log stopped" not in done.stderr:
        return f"leaves a log that is not whole, and says nothing, in {place}"
    return None


def running_outcome(done, answers, folder):
    known = known_outcome(done.returncode, done.stderr, place_of(folder, VIRTUAL)) if done.returncode < 0 else None
    if known:
        return known + (", at rest before" if "stopped" in done.stdout else ", at rest by the drives")
    if done.returncode != 0:
        return f"ends with a line and {done.returncode}"
    return "goes on" if all(answer and answer["done"] for answer in answers) else "goes on, a request is not done"


def running_outcome_of(call, way):
    """Of a daemon in which the first call by that way fails; not all come by it each time, and some only in one
    that is as slow as when ways are looked for."""
    for is_slow in (False, True, True, True):
        with tempfile.TemporaryDirectory() as folder:
            slow = {"FAIL_WAYS": f"{folder}/ways"} if is_slow else {}
            try:
                done, answers = run_daemon(folder, FAIL_CALL=call, FAIL_WAY=way, FAIL_PLACE=f"{folder}/place",
                                           **slow)
            except subprocess.TimeoutExpired:
                return "hangs", f"hangs in {place_of(folder, VIRTUAL)}"
            outcome, trouble = running_outcome(done, answers, folder), \
                running_trouble(done, answers, folder)
            if trouble or place_of(folder, VIRTUAL):
                return outcome, trouble
    return "did not come by that way again", None


def ways(runs):
    """Of each function, the ways to it in so many runs."""
    found = {}
    for _ in range(runs):
        with tempfile.TemporaryDirectory() as folder:
            done, answers = run_daemon(folder, FAIL_WAYS=f"{folder}/ways", FAIL_PLACE=f"{folder}/place")
            trouble = running_trouble(done, answers, folder)
            assert not trouble and all(answer["done"] for answer in answers), trouble
            for line in pathlib.Path(folder, "ways").read_text().splitlines():
                call, way, _ = line.split()
                found.setdefault(call, {})[way.split(":")[0]] = way
    return {call: sorted(those.values()) for call, those in found.items()}


def running_outcomes(most=MOST, runs=4):
    """As outcomes(), of a daemon in virtual time that is asked."""
    for call, those in ways(runs).items():
        for way in spread(those, most):
            yield call, len(those), way, *running_outcome_of(call, way)


def print_table(names):
    print("| Program | Call | There are | Failed | Comes to |\n|---|---|---|---|---|", flush=True)
    for name in names:
        rows = {}
        for call, count, number, outcome, trouble in outcomes(name) if name in RUNS else running_outcomes():
            _, seen = rows.setdefault(call, (count, collections.Counter()))
            seen[f"**{outcome}**" if trouble else outcome] += 1
            if trouble:
                print(f"{name} {call} {number}: {trouble}", file=sys.stderr, flush=True)
        for call, (count, seen) in rows.items():
            said = "; ".join(f"{' '.join(text.split())}: {times}" for text, times in seen.most_common())
            print(f"| {name} | {call} | {count} | {sum(seen.values())} | {said} |", flush=True)


class FailingCallsTest(unittest.TestCase):
    def look_at(self, outcomes_of_all):
        found, looked_at = [], 0
        for call, _, number, _, trouble in outcomes_of_all:
            looked_at += 1
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
                                   ("pthread_create", 2, "tactusd: starting the thread of the control socket: "),
                                   ("pthread_create", 3, "tactusd: starting the thread of the service's watchdog: ")]:
            with tempfile.TemporaryDirectory() as folder:
                done = run("daemon", folder, FAIL_CALL=call, FAIL_AT=str(number))
                self.assertTrue(done.stderr.startswith(said), done.stderr)
                self.assertEqual(done.returncode, 3)

    def test_running(self):
        self.look_at(running_outcomes(runs=1))

    def test_a_look_without_memory_does_not_end_it(self):
        """The first calls of the thread of the control socket are those of its looks, between requests."""
        for number in range(1, 5):
            with tempfile.TemporaryDirectory() as folder:
                done, answers = run_daemon(folder, FAIL_CALL="malloc", FAIL_AT=str(number), FAIL_THREADS="1",
                                           FAIL_PLACE=f"{folder}/place")
                self.assertIsNone(running_trouble(done, answers, folder))

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
        print_table(sys.argv[sys.argv.index("--table") + 1:] or [*RUNS, "running"])
    else:
        unittest.main()
