#!/usr/bin/env python3
"""Prints the longest time, in ms, for which this machine did not run at all what is inside UML.

usage: stall_meter.py    until SIGTERM; above all other priorities, so that only the host delays it
"""
import signal
import sys
import time

STEP_S = 0.01
longest_s = 0.0


def report(*_):
    print(round(1000 * longest_s))
    sys.exit(0)


signal.signal(signal.SIGTERM, report)
while True:
    before_s = time.monotonic()
    time.sleep(STEP_S)
    longest_s = max(longest_s, time.monotonic() - before_s - STEP_S)
