"""The drives as their buses show them: status words, positions, emergencies; and SDO questions."""

import socket
import struct
import threading
import time

FRAME = struct.Struct("=IB3x8s")
STANDARD_FRAME = 0xC00007FF  # mask of filters: the id, and neither extended nor remote
EMERGENCY, TPDO1, SDO_ANSWER, SDO_QUESTION, HEARTBEAT = 0x080, 0x180, 0x580, 0x600, 0x700
PRE_OPERATIONAL = 0x7F
STATUS_WORD, POSITION = 0x6041, 0x6064
NODES = (1, 2, 3)


def open_bus(bus, ids):
    tap = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    filters = b"".join(struct.pack("=II", number, STANDARD_FRAME) for number in ids)
    tap.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, filters)
    tap.bind((bus,))
    return tap


class Bus:
    """One bus with drives; listens all the time."""

    def __init__(self, name):
        self.name = name
        self.status_words = {}  # the last one of each node
        self.positions = {}
        self.node_states = {}
        self.emergencies = []  # (node, error code)
        bases = (EMERGENCY, TPDO1, HEARTBEAT)
        self.tap = open_bus(name, [base + node for base in bases for node in NODES])
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        while True:
            number, _, data = FRAME.unpack(self.tap.recv(FRAME.size))
            node = number & 0x7F
            if number & 0x780 == HEARTBEAT:
                self.node_states[node] = data[0]
            elif number & 0x780 == EMERGENCY:
                self.emergencies.append((node, struct.unpack_from("<H", data)[0]))
            else:
                self.status_words[node], self.positions[node] = struct.unpack_from("<Hi", data)

    def ask(self, node, index, size):
        """An object's value as the drive answers now, by SDO."""
        with open_bus(self.name, [SDO_ANSWER + node]) as questions:
            questions.settimeout(5)
            question = struct.pack("<BHB4x", 0x40, index, 0)
            questions.send(FRAME.pack(SDO_QUESTION + node, 8, question))
            answer = FRAME.unpack(questions.recv(FRAME.size))[2]
        assert answer[0] & 0xE0 == 0x40, f"{self.name} node {node}: no answer for {index:x}"
        return int.from_bytes(answer[4 : 4 + size], "little", signed=size == 4)


class Drives:
    def __init__(self, names):
        self.buses = [Bus(name) for name in names]

    def ask(self, index, size):
        return [bus.ask(node, index, size) for bus in self.buses for node in NODES]

    def positions(self):
        return [bus.positions.get(node) for bus in self.buses for node in NODES]

    def status_words(self):
        """The last ones that drives have sent by themselves."""
        return [bus.status_words.get(node) for bus in self.buses for node in NODES]

    def forget_emergencies(self):
        for bus in self.buses:
            bus.emergencies.clear()

    def emergencies(self):
        """Error codes that drives have told of since then, but for 0, which says that all is well."""
        return [code for bus in self.buses for _, code in bus.emergencies if code != 0]

    def have_left_operation(self):
        """What CiA 301 asks of a node that misses its master's heartbeat."""
        states = [bus.node_states.get(node) for bus in self.buses for node in NODES]
        return all(state == PRE_OPERATIONAL for state in states)

    def are_moving(self):
        before = self.positions()
        time.sleep(0.3)
        return None not in before and self.positions() != before

    def are_at_rest(self):
        """No drive can be in motion: asked twice, each stands where it stood, without being enabled."""
        before = self.ask(POSITION, 4)
        time.sleep(0.1)
        enabled = [is_enabled(word) for word in self.ask(STATUS_WORD, 2)]
        return not any(enabled) and self.ask(POSITION, 4) == before


def has_power(status_word):
    """CiA 402: bit 1 is set in switched on, operation enabled, quick stop and fault reaction active."""
    return status_word & 0x02 != 0


def is_enabled(status_word):
    """CiA 402: operation enabled, quick stop active or fault reaction active. "Switched on" is not:
    the drive takes no setpoint and its motor has no torque."""
    return status_word & 0x04 != 0
