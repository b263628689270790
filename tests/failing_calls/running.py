"""A daemon that runs in virtual time and is asked, while the first call of a function by a way fails."""
import collections
import contextlib
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import time

from failing import (
    LIBRARY, MOST, NOT_AGAIN, PATIENCE_S, ROOT, TACTUS, VIRTUAL, known_outcome, place_of, spread, tried)

COMMANDS = str(ROOT / "config" / "scenes" / "commands.yaml")
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
REST_MS = 1000  # of virtual time


def is_read(log):
    return subprocess.run([TACTUS, "replay", str(log)], capture_output=True, check=False).returncode == 0


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
