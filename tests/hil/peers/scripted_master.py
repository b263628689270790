#!/usr/bin/env python3
"""Leads the nine drives as tactusd does, to test the drives themselves: set-up by SDO, a short
motion in cyclic synchronous velocity, rest, power off. Python-can alone, no CANopen library.

usage: scripted_master.py FOLDER    writes master.json: where each drive was commanded to
"""
import json
import math
import pathlib
import struct
import sys
import time

import can

PERIOD_MS = 40  # long: the drives need 2 ms of the processor, of which there may be little
PERIOD_S = PERIOD_MS / 1000
MOVE_CYCLES = 75
MASTER_ID = 127
SET_UP = [  # index, subindex, bytes, value
    (0x1400, 1, 4, 0x80000200), (0x1600, 0, 1, 0), (0x1600, 1, 4, 0x60400010),
    (0x1600, 2, 4, 0x60FF0020), (0x1600, 0, 1, 2), (0x1400, 2, 1, 1), (0x1400, 1, 4, 0x200),
    (0x1800, 1, 4, 0x80000180), (0x1A00, 0, 1, 0), (0x1A00, 1, 4, 0x60410010),
    (0x1A00, 2, 4, 0x60640020), (0x1A00, 0, 1, 2), (0x1800, 2, 1, 1), (0x1800, 1, 4, 0x180),
    (0x1801, 1, 4, 0x80000280), (0x1802, 1, 4, 0x80000380), (0x1803, 1, 4, 0x80000480),
    (0x1016, 1, 4, MASTER_ID << 16 | 10_000), (0x1017, 0, 2, 100),
    (0x6060, 0, 1, 9), (0x60C2, 1, 1, PERIOD_MS), (0x60C2, 2, 1, 0xFD), (0x605A, 0, 2, 2),
]  # fmt: skip
COB_IDS = [(0x1400, 1), (0x1800, 1), (0x1801, 1), (0x1802, 1), (0x1803, 1)]  # plus node id
# What a drive must refuse once it is set up: index, subindex, bytes, value, abort code.
REFUSED = [
    (0x1600, 1, 4, 0x60400010, 0x08000022),  # mapping of a valid PDO
    (0x1800, 1, 4, 0x281, 0x06090030),  # id of a valid PDO
    (0x6060, 0, 1, 8, 0x06090030),  # mode it does not have
    (0x6041, 0, 2, 0, 0x06010002),  # read-only
    (0x6060, 0, 2, 9, 0x06070010),  # wrong length
    (0x2000, 0, 1, 0, 0x06020000),  # no such object
]
WORD_FOR_STATE = {0x40: 0x06, 0x21: 0x07, 0x23: 0x0F, 0x27: 0x0F}
ENABLED, DISABLED = 0x27, 0x40


class Node:
    def __init__(self, bus, node_id, phase):
        self.bus = bus
        self.node_id = node_id
        self.phase = phase
        self.state = None
        self.position = None
        self.commanded = 0.0  # counts since the start
        self.velocity = 0

    def send(self, base, data):
        message = can.Message(arbitration_id=base + self.node_id, is_extended_id=False, data=data)
        self.bus.send(message)

    def download(self, index, subindex, size, value):
        """The abort code, 0 when the node accepted."""
        command = 0x23 | (4 - size) << 2
        self.send(0x600, struct.pack("<BHBL", command, index, subindex, value))
        end_s = time.monotonic() + 2
        while (left_s := end_s - time.monotonic()) > 0:
            answer = self.bus.recv(left_s)
            if answer is None or answer.arbitration_id != 0x580 + self.node_id:
                continue
            specifier, got_index, got_subindex, code = struct.unpack("<BHBL", answer.data)
            assert (got_index, got_subindex) == (index, subindex), answer
            return 0 if specifier == 0x60 else code
        raise TimeoutError(f"node {self.node_id} does not answer to {index:04X}:{subindex:02X}")

    def set_up(self):
        self.bus.send(nmt(0x80, self.node_id))
        for index, subindex, size, value in SET_UP:
            if (index, subindex) in COB_IDS:
                value += self.node_id
            code = self.download(index, subindex, size, value)
            assert code == 0, f"{index:04X}:{subindex:02X}: abort {code:08X}"
        for index, subindex, size, value, expected in REFUSED:
            code = self.download(index, subindex, size, value)
            assert code == expected, f"{index:04X}:{subindex:02X}: {code:08X}, not {expected:08X}"
        self.bus.send(nmt(0x01, self.node_id))

    def receive(self, message):
        if message.arbitration_id == 0x180 + self.node_id:
            status_word, self.position = struct.unpack("<Hi", message.data)
            self.state = status_word & (0x6F if status_word & 0x20 else 0x4F)


def nmt(command, node_id):
    return can.Message(arbitration_id=0, is_extended_id=False, data=[command, node_id])


def velocity_at(cycle, phase):
    """Counts/s: zero at both ends."""
    envelope = math.sin(math.pi * cycle / MOVE_CYCLES) ** 2
    return round(20_000 * envelope * math.sin(phase))


class Cycle:
    def __init__(self, nodes):
        self.nodes = nodes
        self.buses = list(dict.fromkeys(node.bus for node in nodes))
        self.next_s = time.monotonic()

    def run(self, control_word_of, velocity_of):
        self.next_s += PERIOD_S
        time.sleep(max(0.0, self.next_s - time.monotonic()))
        missed = math.floor((time.monotonic() - self.next_s) / PERIOD_S)
        self.next_s += missed * PERIOD_S
        for node in self.nodes:  # the drives kept the last velocity meanwhile
            node.commanded += node.velocity * PERIOD_S * (missed + 1)
        for bus in self.buses:
            while (message := bus.recv(timeout=0)) is not None:
                for node in self.nodes:
                    if node.bus is bus:
                        node.receive(message)
        for node in self.nodes:
            node.velocity = velocity_of(node)
            node.send(0x200, struct.pack("<Hi", control_word_of(node), node.velocity))
        for bus in self.buses:
            bus.send(can.Message(arbitration_id=0x80, is_extended_id=False))
            bus.send(can.Message(arbitration_id=0x700 + MASTER_ID, is_extended_id=False, data=[5]))
        return missed


def lead(cycle, nodes):
    """Enables, moves and disables; returns missed cycles."""

    def until(state, control_word_of):
        for _ in range(100):
            cycle.run(control_word_of, lambda node: 0)
            if all(node.state == state for node in nodes):
                return
        raise AssertionError(f"not {state:#x} within 100 cycles: {[node.state for node in nodes]}")

    def enable(node):
        return WORD_FOR_STATE.get(node.state, 0)

    until(ENABLED, enable)
    missed = 0
    for number in range(MOVE_CYCLES):
        missed += cycle.run(lambda _: 0x0F, lambda node: velocity_at(number, node.phase))
        lost = [node.node_id for node in nodes if node.state != ENABLED]
        assert not lost, f"drives {lost} left operation enabled"
    until(ENABLED, enable)
    until(DISABLED, lambda _: 0)
    return missed


def main():
    buses = [can.Bus(name, interface="socketcan") for name in ("can0", "can1", "can2")]
    nodes = [Node(bus, node_id, b + node_id) for b, bus in enumerate(buses) for node_id in (1, 2, 3)]
    for node in nodes:
        node.set_up()
    cycle = Cycle(nodes)
    while any(node.position is None for node in nodes):
        cycle.run(lambda _: 0, lambda _: 0)
    starts = [node.position for node in nodes]
    missed = lead(cycle, nodes)
    result = {
        "missed_cycles": missed,
        "period_s": PERIOD_S,
        "moved": [node.position - start for node, start in zip(nodes, starts)],
        "commanded": [node.commanded for node in nodes],
    }
    (pathlib.Path(sys.argv[1]) / "master.json").write_text(json.dumps(result, indent=1))
    for bus in buses:
        bus.shutdown()


if __name__ == "__main__":
    main()
