"""One fault that was injected while the arm moved: what the frames on the buses say of it."""

import json
import re

import candump_log
from candump_log import ENABLE_OPERATION, QUICK_STOP, SYNC

CYCLE_US = 1000
TROUBLE_US = 600_000  # contact_s of guest/faults.sh
SYNC_TAKES_US = 400  # with three setpoints before it, 115 bits each, at 1 Mbit/s
LONG_GAP_US = 50 * CYCLE_US
RESET_NODE_2 = bytes([0x81, 2])


class FaultCase:
    """Times are us of the wall clock of the guest. lost: buses and drives, (bus, node id), that can
    neither be reached nor heard; faulty: drives that stop by themselves."""

    def __init__(self, folder, lost=(), faulty=()):
        self.name = folder.name
        self.lost = lost
        self.faulty = faulty
        self.frames = candump_log.read(folder / "candump.log")
        self.commands = candump_log.commands(self.frames)
        self.statuses = candump_log.statuses(self.frames)
        self.messages = (folder / "tactusd.txt").read_text()
        self.plant = json.loads((folder / "plant.json").read_text())
        marks = folder / "marks.txt"
        self.marks = _marks(marks.read_text()) if marks.exists() else {}
        self.fault_us = self._fault_us()
        self.restart_us = self.marks.get("enable_on", self.frames[-1].t_us + 1)

    def _fault_us(self):
        if "fault" in self.marks:
            return self.marks["fault"]
        if self.name == "interface_down":
            # candump hears no more of this bus until it is up again.
            times = [f.t_us for f in self.frames if f.bus in self.lost]
            return next(a for a, b in zip(times, times[1:]) if b - a > LONG_GAP_US)
        if self.name == "node_reset":
            return next(f.t_us for f in self.frames if f.id == 0 and f.data == RESET_NODE_2)
        return self._enabled_us() + TROUBLE_US

    def _enabled_us(self):
        """When the first drive began to follow, from which the plant counts: with one SYNC, to be
        seen by the next one."""
        seen_us, bus = min((own_status.t_us, node[0]) for node, own in self.statuses.items()
                           for own_status in own if own_status.is_enabled)  # fmt: skip
        syncs = [f.t_us for f in self.frames if f.bus == bus and f.id == SYNC and f.t_us < seen_us]
        return syncs[-2] + SYNC_TAKES_US

    def _is_lost(self, node):
        return node in self.lost or node[0] in self.lost

    def until_restart(self, items):
        return [item for item in items if self.fault_us < item.t_us < self.restart_us]

    def _last(self, nodes, is_there):
        """When the last drive got there for good, in us since the fault; None: never."""
        times = []
        for node, own in nodes.items():
            if self._is_lost(node):
                continue
            items = self.until_restart(own)
            first = len(items)
            while first > 0 and is_there(items[first - 1]):
                first -= 1
            if first == len(items):
                return None
            times.append(items[first].t_us - self.fault_us)
        return max(times)

    def zero_us(self):
        """Zero setpoints for all drives."""
        return self._last(self.commands, lambda command: command.velocity == 0)

    def off_us(self):
        """All drives without power."""
        return self._last(self.statuses, lambda status: status.is_off)

    def brake_us(self):
        """The brake line; None: not before the restart, or there is none."""
        closed_us = self.marks.get("brake", 0)
        return closed_us - self.fault_us if self.fault_us < closed_us < self.restart_us else None

    def quick_stop_us(self):
        """A quick stop for all drives. To one that is off already the same word means less."""
        times = []
        for node, own in self.commands.items():
            if self._is_lost(node) or node in self.faulty:
                continue
            off = [s.t_us for s in self.until_restart(self.statuses[node]) if s.is_off]
            end_us = off[0] if off else self.restart_us
            stops = [c.t_us for c in self.until_restart(own)
                     if c.control_word == QUICK_STOP and c.t_us < end_us]  # fmt: skip
            if not stops:
                return None
            times.append(stops[0] - self.fault_us)
        return max(times)

    def forbidden_commands(self, from_us, may_hold):
        """Of any drive, also of one that has come back: between this time and the restart."""
        late = [c for own in self.commands.values() for c in self.until_restart(own)
                if c.t_us > from_us]  # fmt: skip
        return [c for c in late
                if c.velocity != 0 or (c.control_word == ENABLE_OPERATION and not may_hold)]  # fmt: skip


def _marks(text):
    """What guest/faults.sh did when."""
    found = re.findall(r"^(\w+) \((\d+)\.(\d{6})", text, re.M)
    return {what: int(seconds) * 1_000_000 + int(micros) for what, seconds, micros in found}
