#!/usr/bin/env python3
"""The example in MuJoCo itself: the force that the scene asks for. MuJoCo comes once from PyPI, into
build/hil/mujoco (6 MB); without a network the test fails.

usage: mujoco_test.py FOLDER TACTUS"""

import os
import re
import subprocess
import sys

from common import FOLDER, ROOT

WANTED = ROOT / "tests/python/mujoco_requirements.txt"
VENV = ROOT / "build/hil/mujoco"


def install():
    """The system's Python and NumPy, with MuJoCo beside them."""
    noted = VENV / "installed.txt"
    if noted.exists() and noted.read_bytes() == WANTED.read_bytes():
        return
    subprocess.run([sys.executable, "-m", "venv", "--clear", "--system-site-packages", VENV], check=True)
    subprocess.run([VENV / "bin/python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check",
                    "--retries", "1", "--no-deps", "--only-binary", ":all:", "--require-hashes",
                    "-r", WANTED], check=True)
    noted.write_bytes(WANTED.read_bytes())


install()
done = subprocess.run([VENV / "bin/python", ROOT / "examples/behind_mujoco.py"], text=True, check=True,
                      stdout=subprocess.PIPE,
                      env=os.environ | {"PYTHONPATH": str(FOLDER), "MUJOCO_GL": "disable"})
print(done.stdout)
peak_N, last_N = map(float, re.search(r"force (\S+) N at most, (\S+) N at the end", done.stdout).groups())
assert 4.9 < last_N < 5.1 and peak_N < 6, done.stdout
