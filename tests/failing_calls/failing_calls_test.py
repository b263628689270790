#!/usr/bin/env python3
"""A call of the C library that fails once, at start or end: the program says so in a line and ends with an exit
code of its own, or goes on as if nothing had been. Arguments: tactus, tactusd, the library that makes calls
fail, virtual_daemon. TACTUS_FAILING_CALLS in the environment says how many calls of each kind (0: all); few by
default.
tactusd ends here where it looks for its buses, unless the machine has them. What comes after that is looked at
where its cycle, log and socket run in virtual time (virtual_daemon): a call fails once while it runs."""
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
MOST = int(os.environ.get("TACTUS_FAILING_CALLS", "12"))
MOST_RUNNING = int(os.environ.get("TACTUS_FAILING_CALLS", "4"))  # a daemon each
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


def is_known(name, call, number, count, done):
    """nlohmann-json 3.11 takes memory in its destructor, which may not throw: where there is none while the
    summary is made, simulate says std::bad_alloc and aborts. The log is whole then, no summary is there."""
    is_summary = name == "simulate" and call == "malloc" and number > count - 40
    return is_summary and done.returncode == -6 and "std::bad_alloc" in done.stderr


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


class FailingCallsTest(unittest.TestCase):
    def look_at(self, name):
        found, looked_at = [], 0
        with tempfile.TemporaryDirectory() as folder:
            whole = run(name, folder)
            whole_files = files(folder)
        for call in CALLS:
            with tempfile.TemporaryDirectory() as folder:
                count = pathlib.Path(folder) / "count"
                run(name, folder, FAIL_CALL=call, FAIL_COUNT=str(count))
                numbers = spread(int(count.read_text()))
            for number in numbers:
                looked_at += 1
                with tempfile.TemporaryDirectory() as folder:
                    try:
                        done = run(name, folder, FAIL_CALL=call, FAIL_AT=str(number))
                    except subprocess.TimeoutExpired:
                        found.append(f"{call} {number}: hangs")
                        continue
                    if is_known(name, call, number, numbers[-1], done):
                        continue
                    trouble = trouble_of(done, whole, folder, whole_files)
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
    unittest.main()
