#!/usr/bin/env python3
"""The example in MuJoCo itself, where the system's Python has it: the force that the scene asks for. Ends
with 4, which the tests show as skipped, where it is not there.

usage: mujoco_test.py FOLDER TACTUS"""

import re
import subprocess
import sys

from common import FOLDER, ROOT

done = subprocess.run([sys.executable, ROOT / "examples/behind_mujoco.py"], text=True, stdout=subprocess.PIPE,
                      env={"PYTHONPATH": str(FOLDER)})
print(done.stdout)
if done.returncode == 0:
    peak_N, last_N = map(float, re.search(r"force (\S+) N at most, (\S+) N at the end", done.stdout).groups())
    assert 4.9 < last_N < 5.1 and peak_N < 6, done.stdout
sys.exit(done.returncode)
