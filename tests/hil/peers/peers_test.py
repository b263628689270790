#!/usr/bin/env python3
"""The daemon with drives and tactile module played by third-party packages, on vcan inside UML.

usage: peers_test.py TACTUSD

Runs in the environment that tests/hil/venv makes. What the run leaves behind is in build/hil/peers.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
TIMEOUT_S = 240  # on a loaded machine; 20 s on an idle one


def enter_environment():
    command = [HERE.parent / "venv"]
    venv = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
    if pathlib.Path(sys.prefix) != pathlib.Path(venv):
        python = f"{venv}/bin/python"
        os.execv(python, [python, *sys.argv])


def run_peers(tactusd):
    shutil.rmtree(RESULTS, ignore_errors=True)
    scene = SlowScene(RESULTS / "scene")
    job = [HERE / "guest_job", "--out", RESULTS, "--timeout", str(TIMEOUT_S), "--", sys.executable]
    command = [HERE.parent / "uml", *job, tactusd, scene.path, *scene.initial_positions()]
    status = subprocess.run(command).returncode
    if status != 0:
        sys.exit(f"peers_test: the run ended with status {status}; see {RESULTS}")


enter_environment()
from daemon_checks import Daemon  # noqa: E402, F401
from results import RESULTS  # noqa: E402
from scripted_checks import ScriptedMaster  # noqa: E402, F401
from slow_scene import SlowScene  # noqa: E402

if __name__ == "__main__":
    run_peers(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
