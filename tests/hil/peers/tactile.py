#!/usr/bin/env python3
"""Plays the tactile module on a CAN bus, untouched, until it is told to stop.

usage: tactile.py BUS SYNC_BUS

A sample for each SYNC on SYNC_BUS, and ten a second where there is none: a machine too slow for the
daemon slows the module down, too, instead of making a flood of it. Frames 0x100 + k, k = 0..3, with
sequence number, status 0 and two channels of 24 bits. The channels carry a few counts of noise, as
strain gauges do; 100 000 counts are 1 N.
"""
import itertools
import random
import select
import signal
import socket
import struct
import sys

FIRST_ID = 0x100
SYNC_ID = 0x080
LONGEST_PAUSE_S = 0.1
NOISE_COUNTS = 50
FRAME = struct.Struct("<IB3x8s")  # struct can_frame
FILTER = struct.Struct("<II")  # struct can_filter


def frames(sequence, noise):
    for k in range(4):
        data = bytes([sequence, 0])
        for _ in range(2):
            counts = noise.randint(-NOISE_COUNTS, NOISE_COUNTS)
            data += counts.to_bytes(3, "little", signed=True)
        yield FRAME.pack(FIRST_ID + k, len(data), data)


def open_bus(name, filters):
    bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    bus.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, filters)
    bus.bind((name,))
    return bus


def wait_for_sync(bus):
    """Several that wait are one: a module sends its next sample, not the missed ones."""
    select.select([bus], [], [], LONGEST_PAUSE_S)
    try:
        while True:
            bus.recv(FRAME.size, socket.MSG_DONTWAIT)
    except BlockingIOError:
        pass


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    noise = random.Random(1)
    bus = open_bus(sys.argv[1], b"")  # it only sends
    syncs = open_bus(sys.argv[2], FILTER.pack(SYNC_ID, 0x7FF))
    for sequence in itertools.cycle(range(256)):
        for frame in frames(sequence, noise):
            bus.send(frame)
        wait_for_sync(syncs)


if __name__ == "__main__":
    main()
