"""Programs that start and end, while the n-th call of a function fails."""
import json
import os
import pathlib
import socket
import subprocess
import tempfile

from failing import LIBRARY, MOST, PATIENCE_S, ROOT, TACTUS, TACTUSD, known_outcome, place_of, spread, tried

SCENE = str(ROOT / "config" / "scenes" / "scenario1_null_space.yaml")
RUNS = {"check": [TACTUS, "check", SCENE],
        "simulate": [TACTUS, "simulate", SCENE, "--set", "simulation.duration_s=0.05", "-o", "out"],
        "daemon": [TACTUSD, "scene.yaml", "-o", "out"]}


def run(name, folder, **failure):
    """The daemon has buses on which nobody answers, whatever the machine has, and a service manager."""
    pathlib.Path(folder, "scene.yaml").write_text(f"extends: {SCENE}\nreal_time: {{required: false}}\n")
    environment = {**os.environ, "LD_PRELOAD": LIBRARY, "FAIL_BUSES": "1", "RUNTIME_DIRECTORY": folder,
                   "NOTIFY_SOCKET": f"{folder}/notify", "WATCHDOG_USEC": "1000000", **failure}
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(f"{folder}/notify")
        return subprocess.run(RUNS[name], cwd=folder, env=environment, capture_output=True, text=True,
                              timeout=PATIENCE_S, check=False)


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(pathlib.Path(folder, "out").rglob("*")) if path.is_file()}


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
