#!/usr/bin/python3
"""Counts the instructions of each step that PROGRAM dumps, and fails if one is above the budget.

usage: worst_budget.py PROGRAM BUDGET [ARGUMENT]     PROGRAM prints how many steps it dumped"""

import pathlib
import re
import subprocess
import sys
import tempfile


def instructions_of_each_step(command):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder, "out")
        result = subprocess.run(
            ["valgrind", "--tool=callgrind", "--collect-atstart=no", "--combine-dumps=yes",
             f"--callgrind-out-file={out}", *command], capture_output=True, encoding="utf-8",
            check=True)
        text = "".join(path.read_text() for path in pathlib.Path(folder).iterdir())
    counts = [int(count) for count in re.findall(r"^totals: (\d+)", text, re.MULTILINE)]
    return [count for count in counts if count > 0], int(result.stdout)


def main():
    budget = float(sys.argv[2])
    counts, steps = instructions_of_each_step(sys.argv[1:2] + sys.argv[3:])
    mean, worst = sum(counts) / len(counts), max(counts)
    print(f"at most {worst} instructions (mean of {len(counts)}: {mean:.0f}), budget {budget:.0f}")
    return 0 if len(counts) == steps > 1000 and 500 < worst <= budget else 1


if __name__ == "__main__":
    sys.exit(main())
