#!/usr/bin/python3
"""Fails where a whole control step takes too large a share of the instructions of other code.

usage: step_ratios.py TACTUS"""

import json
import subprocess
import sys

SIZES = (6, 7, 9, 12, 16)
# (code, its contacts, other code, its contacts, largest share). What a compiler and Debian's KDL make
# of the other code may change, hence some slack over what was measured.
LIMITS = [
    ("ours", 0, "KDL wdls", 0, 0.039),
    ("ours", 1, "KDL wdls", 1, 0.036),
    ("ours", 0, "KDL wdls, one solve", 0, 0.088),
    ("ours", 0, "Eigen SVD", 0, 0.145),
    ("ours", 1, "Eigen SVD", 1, 0.18),
    ("ours, sensor to command", 1, "ours", 1, 0.49),
]
LARGEST_DEVIATION_FROM_LINE = 0.05


def deviation_from_line(values):
    """The largest relative distance of a value from the least-squares line over SIZES."""
    mean_x, mean_y = sum(SIZES) / len(SIZES), sum(values) / len(SIZES)
    slope = (sum((x - mean_x) * (y - mean_y) for x, y in zip(SIZES, values))
             / sum((x - mean_x) ** 2 for x in SIZES))
    return max(abs(mean_y + slope * (x - mean_x) - y) / y for x, y in zip(SIZES, values))


def main():
    command = [sys.argv[1], "bench", "--quick", "--json", "--study", "step"]
    output = subprocess.run(command, capture_output=True, encoding="utf-8", check=True).stdout
    counts = {(row["code"], row["joints"], row["contacts"]): row["instructions"]
              for row in json.loads(output)["step"] if row["task_components"] == 3}
    is_good = True
    for code, contacts, other, other_contacts, limit in LIMITS:
        shares = [counts[code, n, contacts] / counts[other, n, other_contacts] for n in SIZES]
        print(f"{code}, {contacts} contacts: up to {max(shares):.4f} of {other}, at most {limit}")
        is_good = is_good and 0.0 < min(shares) <= max(shares) <= limit
    for contacts in (0, 1):
        deviation = deviation_from_line([counts["ours", n, contacts] for n in SIZES])
        print(f"{contacts} contacts: {deviation:.4f} off a straight line over the joints")
        is_good = is_good and deviation <= LARGEST_DEVIATION_FROM_LINE
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
