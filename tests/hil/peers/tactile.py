#!/usr/bin/env python3
"""Plays the tactile module on a CAN bus, untouched, until it is told to stop.

usage: tactile.py BUS

A sample each 20 ms: frames 0x100 + k, k = 0..3, with sequence number, status 0 and two channels of
24 bits. The channels carry a few counts of noise, as strain gauges do; 100 000 counts are 1 N.
"""
import random
import signal
import socket
import struct
import sys
import time

FIRST_ID = 0x100
PERIOD_S = 0.02
NOISE_COUNTS = 50
FRAME = struct.Struct("<IB3x8s")  # struct can_frame


def frames(sequence, noise):
    for k in range(4):
        data = bytes([sequence, 0])
        for _ in range(2):
            counts = noise.randint(-NOISE_COUNTS, NOISE_COUNTS)
            data += counts.to_bytes(3, "little", signed=True)
        yield FRAME.pack(FIRST_ID + k, len(data), data)


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    noise = random.Random(1)
    sequence = 0
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as bus:
        bus.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, b"")  # it only sends
        bus.bind((sys.argv[1],))
        due_s = time.monotonic()
        while True:
            for frame in frames(sequence, noise):
                bus.send(frame)
            sequence = (sequence + 1) % 256
            # A module that could not send in time sends its next sample, not the missed ones.
            due_s = max(due_s + PERIOD_S, time.monotonic() - PERIOD_S)
            time.sleep(max(0.0, due_s - time.monotonic()))


if __name__ == "__main__":
    main()
