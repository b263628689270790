#!/usr/bin/python3
"""Counts the instructions of one control step, or a part of it, and fails above the budget.

usage: instruction_budget.py PROGRAM BUDGET [ARGUMENT]     PROGRAM prints how many steps it had
collected"""

import re
import subprocess
import sys


def instructions_a_step(command):
    result = subprocess.run(
        ["valgrind", "--tool=callgrind", "--collect-atstart=no", "--callgrind-out-file=/dev/null",
         *command], capture_output=True, encoding="utf-8", check=True)
    steps = int(result.stdout)
    collected = re.search(r"Collected\s*:\s*(\d+)", result.stderr)
    return int(collected.group(1)) / steps, steps


def main():
    budget = float(sys.argv[2])
    count, steps = instructions_a_step(sys.argv[1:2] + sys.argv[3:])
    print(f"{count:.0f} instructions a control step (mean of {steps}), budget {budget:.0f}")
    # A count far too small would mean that nothing was measured.
    return 0 if 500 < count <= budget and steps > 1000 else 1


if __name__ == "__main__":
    sys.exit(main())
