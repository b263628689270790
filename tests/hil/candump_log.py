"""Reads candump's log of a run as CANopen drives and their master would."""

import re
from dataclasses import dataclass

SYNC, EMERGENCY, TPDO, RPDO, HEARTBEAT = 0x080, 0x080, 0x180, 0x200, 0x700
SDO_REQUEST, SDO_ANSWER = 0x600, 0x580
NMT, MASTER_HEARTBEAT = 0x000, 0x77F
NMT_STOP, NMT_PRE_OPERATIONAL, NMT_RESET_NODE, NMT_RESET_COMMUNICATION = 0x02, 0x80, 0x81, 0x82
POSITION_IS = bytes([0x43, 0x64, 0x60, 0x00])  # an SDO answer: four bytes of object 6064:00
QUICK_STOP, ENABLE_OPERATION = 0x02, 0x0F
# Error frames and extended frames have eight digits.
LINE = re.compile(r"\((\d+)\.(\d{6})\) (\w+) ([0-9A-F]{8}|[0-9A-F]{3})#([0-9A-F]*|R\d?)$")


@dataclass(frozen=True)
class Frame:
    t_us: int
    bus: str
    id: int
    is_standard: bool
    data: bytes

    @property
    def node(self):
        return self.bus, self.id & 0x7F

    def number(self, start, size, signed=False):
        return int.from_bytes(self.data[start : start + size], "little", signed=signed)


@dataclass(frozen=True)
class Command:
    t_us: int
    control_word: int
    velocity: int  # counts per second


@dataclass(frozen=True)
class Status:
    t_us: int
    status_word: int

    @property
    def is_enabled(self):
        return self.status_word & 0x6F == 0x27

    @property
    def is_off(self):
        """Neither operation enabled nor quick stop active nor fault reaction active (CiA 402)."""
        return not self.is_enabled and self.status_word & 0x6F != 0x07 and (
            self.status_word & 0x4F != 0x0F)  # fmt: skip


def read(path):
    frames = []
    for line in path.read_text().splitlines():
        match = LINE.match(line)
        if match is None:
            raise ValueError(f"{path}: not a line of candump: {line}")
        seconds, micros, bus, frame_id, data = match.groups()
        is_remote = data.startswith("R")
        frames.append(
            Frame(int(seconds) * 1_000_000 + int(micros), bus, int(frame_id, 16),
                  len(frame_id) == 3 and not is_remote, b"" if is_remote else bytes.fromhex(data))
        )  # fmt: skip
    return frames


def _of_nodes(frames, function, size):
    """Frames of this function and size, by drive: (bus, node id)."""
    nodes = {}
    for frame in frames:
        if frame.is_standard and function < frame.id < function + 0x80 and len(frame.data) == size:
            nodes.setdefault(frame.node, []).append(frame)
    return nodes


def commands(frames):
    """The master's RPDOs: control word and target velocity."""
    return {
        node: [Command(f.t_us, f.number(0, 2), f.number(2, 4, signed=True)) for f in own]
        for node, own in _of_nodes(frames, RPDO, 6).items()
    }


def statuses(frames):
    """The drives' TPDOs."""
    return {
        node: [Status(f.t_us, f.number(0, 2)) for f in own]
        for node, own in _of_nodes(frames, TPDO, 6).items()
    }


def positions(frames):
    """Counts, by drive: (time, position)."""
    return {
        node: [(f.t_us, f.number(2, 4, signed=True)) for f in own]
        for node, own in _of_nodes(frames, TPDO, 6).items()
    }


def asked_positions(frames):
    """Counts, by drive that was asked by SDO: (time, position)."""
    return {
        node: [(f.t_us, f.number(4, 4, signed=True)) for f in own if f.data[:4] == POSITION_IS]
        for node, own in _of_nodes(frames, SDO_ANSWER, 8).items()
    }


def boot_ups(frames, node):
    """When this drive said that it has started anew."""
    return [f.t_us for f in frames
            if f.node == node and f.id > HEARTBEAT and f.data == b"\0"]  # fmt: skip


def nmt(frames, node):
    """What this drive alone was told: (time, command)."""
    return [(f.t_us, f.data[0]) for f in frames
            if f.bus == node[0] and f.id == NMT and f.data[1:] == bytes([node[1]])]  # fmt: skip


def of_master(frames, bus):
    """All that it sends there."""
    functions = {RPDO, SDO_REQUEST}
    return [f for f in frames if f.bus == bus and f.is_standard and (
        f.id in (NMT, SYNC, MASTER_HEARTBEAT) or f.id & ~0x7F in functions)]  # fmt: skip


def emergencies(frames):
    """By drive: (time, error code)."""
    return {
        node: [(f.t_us, f.number(0, 2)) for f in own]
        for node, own in _of_nodes(frames, EMERGENCY, 8).items()
    }
