#!/usr/bin/python3
"""Counts what each further contact adds to a control step, and fails above the budget.

usage: contact_budget.py PROGRAM BUDGET     PROGRAM MODULES CONTACTS prints how many steps it had
collected"""

import sys

from instruction_budget import instructions_a_step

MODULES = 3


def main():
    program, budget = sys.argv[1], float(sys.argv[2])
    counts = [instructions_a_step([program, str(MODULES), str(contacts)])[0]
              for contacts in range(1, MODULES + 1)]
    added = [more - less for less, more in zip(counts, counts[1:])]
    for contacts, count in enumerate(counts, 1):
        print(f"{contacts} contacts on {MODULES} modules: {count:.0f} instructions a control step")
    print(f"each further contact: at most {max(added):.0f}, budget {budget:.0f}")
    return 0 if 100 < min(added) <= max(added) <= budget else 1


if __name__ == "__main__":
    sys.exit(main())
