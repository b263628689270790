#!/usr/bin/env python3
"""A call of the C library that fails once, at start or end: the program says so in a line and ends with an exit
code of its own, or goes on as if nothing had been. Arguments: tactus, tactusd, the library that makes calls
fail. TACTUS_FAILING_CALLS in the environment says how many calls of each kind (0: all); few by default.
tactusd ends here where it looks for its buses, unless the machine has them: what comes after that is not
looked at."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = str(ROOT / "config" / "scenes" / "scenario1_null_space.yaml")
TACTUS, TACTUSD, LIBRARY = (str(pathlib.Path(sys.argv.pop(1)).resolve()) for _ in range(3))
MOST = int(os.environ.get("TACTUS_FAILING_CALLS", "12"))
CALLS = ["malloc", "open", "read", "write", "close", "fsync", "rename", "mkdir", "stat", "unlink", "mmap",
         "socket", "mlockall"]
RUNS = {"check": [TACTUS, "check", SCENE],
        "simulate": [TACTUS, "simulate", SCENE, "--set", "simulation.duration_s=0.05", "-o", "out"],
        "daemon": [TACTUSD, SCENE, "-o", "out"]}


def run(name, folder, **failure):
    environment = {**os.environ, "LD_PRELOAD": LIBRARY, **failure}
    return subprocess.run(RUNS[name], cwd=folder, env=environment, capture_output=True, text=True,
                          timeout=120, check=False)


def spread(count):
    """Which of so many calls fail: all, or as many as may be, the first and the last among them."""
    if MOST == 0 or count <= MOST:
        return list(range(1, count + 1))
    return sorted({1 + i * (count - 1) // (MOST - 1) for i in range(MOST)})


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

    def test_a_crash_and_a_cut_log_are_seen(self):
        whole = subprocess.CompletedProcess([], 0, "", "")
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("crashes", trouble_of(subprocess.CompletedProcess([], -6, "", ""), whole, folder, {}))
            (pathlib.Path(folder) / "run.ulg").write_bytes(b"U")
            self.assertIn("cuts", trouble_of(whole, whole, folder, {"run.ulg": b"ULog"}))
            self.assertIn("leaves out", trouble_of(whole, whole, folder, {"run.ulg": b"", "a": b""}))


if __name__ == "__main__":
    unittest.main()
