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
import bisect
import collections
import contextlib
import functools
import json
import os
import pathlib
import random
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = str(ROOT / "config" / "scenes" / "scenario1_null_space.yaml")
COMMANDS = str(ROOT / "config" / "scenes" / "commands.yaml")
TACTUS, TACTUSD, LIBRARY, VIRTUAL = (str(pathlib.Path(sys.argv.pop(1)).resolve()) for _ in range(4))
IS_TABLE = "--table" in sys.argv
FOUND = os.environ.get("TACTUS_FAILING_CALLS_FOUND")
END_S = time.monotonic() + float(os.environ.get("TACTUS_FAILING_CALLS_S", "inf"))
MOST = int(os.environ.get("TACTUS_FAILING_CALLS", "4"))
PATIENCE_S = 20
RUNS = {"check": [TACTUS, "check", SCENE],
        "simulate": [TACTUS, "simulate", SCENE, "--set", "simulation.duration_s=0.05", "-o", "out"],
        "daemon": [TACTUSD, "scene.yaml", "-o", "out"]}
# What a daemon that runs is asked, together; of the last it does nothing. Then whether it still does.
REQUESTS = {
    "gains": [{"do": "show"}, {"do": "set", "values": {"controller.damping": 0.7}}, {"do": "undo"}],
    "gains for a time": [{"do": "set", "values": {"controller.damping": 0.7}, "for_s": 60}, {"do": "undo"}],
    "file": [{"do": "reload"}, {"do": "reload", "only_read": True}],
    "tool": [{"do": "move", "to_m": [0, 0.02, 0], "relative": True},
             {"do": "follow", "waypoints": [{"to_m": [0, -0.01, 0], "relative": True, "pause_s": 0.1},
                                            {"to_m": [0, -0.01, None], "relative": True}]},
             {"do": "hold"}, {"do": "stream", "to_m": [0.001, 0, 0], "relative": True}],
    "refused": [{"do": "jump"}, {"do": "set", "values": {"controller.dampin": 1}},
                {"do": "set", "values": {"controller.damping": -1}}, {"do": "move"}, {"do": "move", "to_m": [9, 9, 9]},
                "no object"]}
AFTER = [{"do": "show"}, {"do": "move", "to_m": [0, -0.001, 0], "relative": True}, {"do": "hold"}]
NOT_AGAIN = "did not come by that way again"
REST_MS = 1000  # of virtual time


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
    """Which of them fail: all, in an order in which the first are a sample, or as many as may be, the first and the
    last among them."""
    if most == 0:
        return random.Random(1).sample(those, len(those))
    if len(those) <= most:
        return list(those)
    return [those[i] for i in sorted({i * (len(those) - 1) // (most - 1) for i in range(most)})]


@functools.lru_cache
def found_before():
    lines = pathlib.Path(FOUND).read_text().splitlines() if FOUND and os.path.exists(FOUND) else []
    return {key: found for key, *found in map(json.loads, lines)}


def tried(key, try_it):
    """[(outcome, trouble)], as it was found before, or now; [] if there is no time left."""
    if key in found_before():
        return [found_before()[key]]
    if time.monotonic() > END_S:
        return []
    found = try_it()
    if FOUND:
        with open(FOUND, "a") as file:
            file.write(json.dumps([key, *found]) + "\n")
    return [found]


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
    """(function, how many calls there are, how many to try, the one that failed, what it came to, what is wrong with
    that) of each."""
    with tempfile.TemporaryDirectory() as folder:
        whole = run(name, folder, FAIL_COUNT=f"{folder}/count")
        whole_files = files(folder)
        assert has_run(whole) or name != "daemon", whole.stderr
        counts = [line.split() for line in pathlib.Path(folder, "count").read_text().splitlines()]
    for call, count in sorted(counts, key=lambda one: int(one[1])):
        for number in spread(range(1, int(count) + 1), most):
            for found in tried(f"{name} {call} {number}",
                               lambda: outcome_of(name, call, number, whole, whole_files)):
                yield call, int(count), int(count), number, *found


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


@contextlib.contextmanager
def virtual_daemon(folder, scene, stderr=subprocess.PIPE, **environment):
    """One that runs: (process, path of its control socket)."""
    pathlib.Path(folder, "log").mkdir()
    process = subprocess.Popen([VIRTUAL, "--log", "log", "20", scene], cwd=folder,
                               env={**os.environ, "RUNTIME_DIRECTORY": folder, **environment},
                               stdout=subprocess.PIPE, stderr=stderr, text=True)
    try:
        assert process.stdout.readline() == "running\n"
        path = str(pathlib.Path(folder, "control"))
        while not (ask(path, {"do": "show"}) or {"task": {}})["task"].get("is_running"):
            time.sleep(0.01)
        yield process, path
    finally:
        process.kill()
        process.communicate()


def run_daemon(folder, asked, **failure):
    """A daemon that is asked until it is told to end: (process, requests that did not end as they should)."""
    lost = []
    with virtual_daemon(folder, COMMANDS, LD_PRELOAD=LIBRARY, FAIL_SIGNAL="1", **failure) as (process, path):
        process.send_signal(signal.SIGUSR2)
        for request in REQUESTS[asked] + AFTER:
            answer = ask(path, request)
            if not answer or answer["done"] != (request in AFTER or asked != "refused"):
                lost.append((request, answer and answer.get("error")))
        if "FAIL_WAYS" in failure:
            time.sleep(0.6)  # until the status is due again
        process.terminate()
        said, errors = process.communicate(timeout=PATIENCE_S)
        return subprocess.CompletedProcess([], process.returncode, said, errors), lost


def running_trouble(done, lost, folder):
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
    of_set = [error for _, error in lost[1:] if error == "undo: nothing was changed before"]
    if len(lost) - len(of_set) > 1:
        return f"does not do {lost} in {place}: {done.stderr[-300:]}"
    if not is_read(f"{folder}/log/run.ulg") and "log stopped" not in done.stderr:
        return f"leaves a log that is not whole, and says nothing, in {place}"
    return None


def running_outcome(done, lost, folder):
    known = known_outcome(done.returncode, done.stderr, place_of(folder, VIRTUAL)) if done.returncode < 0 else None
    if known:
        return known + (", at rest before" if "stopped" in done.stdout else ", at rest by the drives")
    if done.returncode != 0:
        return f"ends with a line and {done.returncode}"
    return "goes on, a request is not done" if lost else "goes on"


def running_outcome_of(asked, call, way):
    """Of a daemon in which the first call by that way fails; not all come by it each time, and some only in one
    that is as slow as when ways are looked for."""
    for is_slow in (False, True, True, True):
        with tempfile.TemporaryDirectory() as folder:
            slow = {"FAIL_WAYS": f"{folder}/ways"} if is_slow else {}
            try:
                done, lost = run_daemon(folder, asked, FAIL_CALL=call, FAIL_WAY=way,
                                        FAIL_PLACE=f"{folder}/place", **slow)
            except subprocess.TimeoutExpired:
                return "hangs", f"hangs in {place_of(folder, VIRTUAL)}"
            outcome, trouble = running_outcome(done, lost, folder), running_trouble(done, lost, folder)
            if trouble or place_of(folder, VIRTUAL):
                return outcome, trouble
    return NOT_AGAIN, None


def ways(runs):
    """Of each function, the ways to it in so many runs of all requests: (what is asked first that comes by it, way);
    and how many calls there are in a run."""
    found, counts = {}, collections.Counter()
    for asked in [*REQUESTS] * runs:
        with tempfile.TemporaryDirectory() as folder:
            done, lost = run_daemon(folder, asked, FAIL_WAYS=f"{folder}/ways", FAIL_PLACE=f"{folder}/place")
            trouble = running_trouble(done, lost, folder)
            assert not trouble and not lost, (trouble, lost)
            for line in pathlib.Path(folder, "ways").read_text().splitlines():
                call, way, count = line.split()
                counts[call] += int(count)
                found.setdefault(call, {}).setdefault(way.split(":")[0], (asked, way))
    return {call: (counts[call] // runs, list(those.values())) for call, those in found.items()}


def running_outcomes(most=MOST, runs=3):
    """As outcomes(), of a daemon in virtual time that is asked."""
    for call, (count, those) in sorted(ways(runs).items(), key=lambda one: len(one[1][1])):
        for asked, way in spread(those, most):
            for found in tried(f"running {call} {way.split(':')[0]}", lambda: running_outcome_of(asked, call, way)):
                yield call, count, len(those), way, *found


class Saves:
    """`tactus save` of a gain of a daemon that runs, again and again."""
    BEFORE = f"extends: {COMMANDS}\ncontroller:\n  damping: 1  # of the engineer\n"

    def __init__(self, folder, path):
        self.folder, self.path, self.scene = folder, path, pathlib.Path(folder, "scene.yaml")
        self.after = ""

    def run(self, **failure):
        self.scene.write_text(self.BEFORE)
        for request in [{"do": "reload"}, {"do": "set", "values": {"controller.damping": 0.7}}]:
            assert ask(self.path, request)["done"]
        pathlib.Path(self.folder, "place").unlink(missing_ok=True)
        environment = {**os.environ, "LD_PRELOAD": LIBRARY, "RUNTIME_DIRECTORY": self.folder,
                       "FAIL_PLACE": f"{self.folder}/place", **failure}
        return subprocess.run([TACTUS, "save"], env=environment, capture_output=True, text=True,
                              timeout=PATIENCE_S, check=False)

    def outcome_of(self, call, way):
        """The scene's file is as it was, or as it is to be, whatever fails."""
        done = self.run(FAIL_CALL=call, FAIL_WAY=way)
        place, text = place_of(self.folder, TACTUS), self.scene.read_text()
        left = [path for path in pathlib.Path(self.folder).glob("scene.yaml.??????")]
        for path in left:
            path.unlink()
        known = known_outcome(done.returncode, done.stderr, place)
        outcome = known or f"ends with a line and {done.returncode}" if done.returncode else "as without"
        trouble = None
        if text not in (self.BEFORE, self.after) or done.returncode == 0 and text != self.after:
            trouble = f"leaves {text} in {place}"
        elif done.returncode < 0 and not known or done.returncode > 0 and not done.stderr:
            trouble = f"ends ({done.returncode}) in {place}: {done.stderr}"
        elif left and not known and call != "unlink":
            trouble = f"leaves {left} in {place}: {done.stderr}"
        elif text == self.after and done.returncode > 0 and call != "malloc" and \
                not re.search("is written|standard output", done.stderr):
            trouble = f"saves, and does not say so: {done.stderr}"
        elif not place:
            outcome = NOT_AGAIN
        if done.returncode > 0:
            outcome += ", saved" if text == self.after else ", not saved"
        return outcome, trouble


def save_outcomes(most=MOST):
    """As running_outcomes(), of a save."""
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "scene.yaml").write_text(Saves.BEFORE)
        with virtual_daemon(folder, "scene.yaml", subprocess.DEVNULL) as (_, path):  # who reads no pipe fills it
            saves = Saves(folder, path)
            done = saves.run(FAIL_WAYS=f"{folder}/ways")
            saves.after = saves.scene.read_text()
            assert done.returncode == 0 and "damping: 0.7  # of" in saves.after, done.stderr
            found = {}
            for line in pathlib.Path(folder, "ways").read_text().splitlines():
                call, way, count = line.split()
                found.setdefault(call, []).append((way, int(count)))
            for call, those in sorted(found.items(), key=lambda one: len(one[1])):
                for way, _ in spread(those, most):
                    for outcome in tried(f"save {call} {way.split(':')[0]}", lambda: saves.outcome_of(call, way)):
                        yield call, sum(count for _, count in those), len(those), way, *outcome


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
                                   ("pthread_create", 2, "tactusd: starting the thread of the control socket: "),
                                   ("pthread_create", 3, "tactusd: starting the thread of the service's watchdog: ")]:
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
