#!/usr/bin/python3
"""Fails where a whole control step takes too large a share of the instructions of other code.

usage: step_ratios.py TACTUS"""

import json
import subprocess
import sys

SIZES = (6, 7, 9, 12, 16)
# (contacts of ours, the other code, its contacts, largest share). The others come from Debian or
# from the compiler's choices, hence some slack over what was measured.
LIMITS = []
LARGEST_DEVIATION_FROM_LINE = 0.05


def main():
    command = [sys.argv[1], "bench", "--quick", "--json", "--study", "step"]
    output = subprocess.run(command, capture_output=True, encoding="utf-8", check=True).stdout
    tables = json.loads(output)
    counts = {(row["code"], row["joints"], row["contacts"]): row["instructions"]
              for row in tables["step"] if row["task_components"] == 3}
    is_good = True
    for contacts, code, other_contacts, limit in LIMITS:
        for joints in SIZES:
            share = counts["ours", joints, contacts] / counts[code, joints, other_contacts]
            print(f"{joints} joints, {contacts} contacts: {share:.4f} of {code}, at most {limit}")
            is_good = is_good and 0.0 < share <= limit
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
