"""One CiA 402 drive on a CAN bus: a LocalNode of the package canopen, a power state machine and an
ideal axis that turns target velocity into position."""
import math

import canopen
from canopen.objectdictionary import INTEGER_TYPES, ODVariable
from canopen.sdo.exceptions import SdoAbortedError

import cia402
from object_dictionary import CYCLIC_SYNCHRONOUS_VELOCITY, PDO_NOT_VALID, drive_object_dictionary

ABORT_CANNOT_MAP = 0x06040041
ABORT_PDO_TOO_LONG = 0x06040042
ABORT_VALUE = 0x06090030
ABORT_DEVICE_STATE = 0x08000022
EMCY_HEARTBEAT = 0x8130
EMCY_NOT_OPERATIONAL = 0x8100
EMCY_PDO_LENGTH = 0x8210
LAST_SYNCHRONOUS_TYPE = 240
# Objects that the drive itself changes.
MEASURED = {
    0x1001: lambda drive: 1 if drive.error else 0,
    0x603F: lambda drive: drive.error,
    0x6041: lambda drive: drive.power.status_word,
    0x6061: lambda drive: drive.value(0x6060),
    0x6064: lambda drive: (round(drive.position) + 2**31) % 2**32 - 2**31,
    0x606C: lambda drive: round(drive.velocity),
}


class PeriodCounter:
    """Counts periods between SYNCs by their time stamps: a master that skips a cycle leaves the
    axis moving for two. SYNCs come late by any part of a period, never early, so the earliest one
    gives the phase."""

    def __init__(self):
        self._anchor_s = None
        self._count = 0

    def advance(self, time_s, period_s):
        if self._anchor_s is None:
            self._anchor_s = time_s
        count = math.floor((time_s - self._anchor_s) / period_s + 0.25)
        self._anchor_s = min(self._anchor_s, time_s - count * period_s)
        advanced, self._count = count - self._count, count
        return advanced


class Drive:
    def __init__(self, network, bus, node_id, position):
        self.bus = bus
        self.position = float(position)  # counts
        self.velocity = 0.0  # counts/s
        self.pdos_of_wrong_length = 0
        self.stops_without_ramp = 0
        self.emergencies = []
        self.rows = []
        self.on_reset = lambda drive: None  # the master's, which leaves nothing of its set-up
        self.node = canopen.LocalNode(node_id, drive_object_dictionary(node_id))
        network.add_node(self.node)
        self.node.add_read_callback(self._read)
        self.node.add_write_callback(self._write)
        for receive_map in self.node.rpdo.values():
            receive_map.add_callback(self._on_rpdo)
        network.subscribe(0x000, self._on_nmt)  # after the library's own handler
        network.subscribe(0x080, self._on_sync)
        self._network = network
        self.power_on()

    def power_on(self):
        self.power = cia402.PowerStateMachine()
        self.node.data_store.clear()
        self._written = {}
        self.velocity = 0.0
        self._periods = PeriodCounter()
        self._waiting = {}  # synchronous RPDOs, until the next SYNC
        self._watch = None  # node id, time-out and time of the last heartbeat
        self.error = 0
        self.node.nmt.state = "INITIALISING"  # sends boot-up
        self.node.nmt.state = "PRE-OPERATIONAL"
        self._nmt = self.node.nmt.state

    def value(self, index, subindex=0):
        """An object that only the master writes. The library's own way to it takes far longer."""
        try:
            return self._written[index, subindex]
        except KeyError:
            entry = self.node.object_dictionary[index]
            return (entry if isinstance(entry, ODVariable) else entry[subindex]).default

    def power_off(self):
        self.node.nmt.stop_heartbeat()

    def idle(self, time_s):
        """Nothing is on the bus: time passes all the same."""
        self._check_heartbeat(time_s)

    # --- network management and object dictionary

    def _on_nmt(self, _id, _data, _time_s):
        before, self._nmt = self._nmt, self.node.nmt.state
        if self._nmt == "INITIALISING":
            self.on_reset(self)
            self.power_on()
        elif self._nmt == "OPERATIONAL" != before:
            for pdo_map in (*self.node.rpdo.values(), *self.node.tpdo.values()):
                pdo_map.read()
            self._periods = PeriodCounter()
        elif before == "OPERATIONAL" != self._nmt and self.power.state == cia402.OPERATION_ENABLED:
            self._lose_connection(EMCY_NOT_OPERATIONAL)

    def _on_heartbeat(self, _id, _data, time_s):
        if self._watch:
            self._watch[2] = time_s

    def _check_heartbeat(self, time_s):
        if not self._watch or self._watch[2] is None or time_s - self._watch[2] < self._watch[1]:
            return
        self._watch[2] = None  # until it beats again
        self._lose_connection(EMCY_HEARTBEAT)

    def _read(self, index, subindex, od):
        measure = MEASURED.get(index)
        return measure(self) if measure else None

    def _write(self, index, subindex, od, data):
        if od.data_type not in INTEGER_TYPES:
            return
        value = od.decode_raw(data)
        if 0x1400 <= index <= 0x15FF or 0x1800 <= index <= 0x19FF:
            self._check_communication(index, subindex, value)
        elif 0x1600 <= index <= 0x17FF or 0x1A00 <= index <= 0x1BFF:
            self._check_mapping(index, subindex, value)
        elif index == 0x1016 and subindex == 1:
            node_id = value >> 16 & 0x7F
            self._watch = [node_id, (value & 0xFFFF) / 1000, None] if value & 0xFFFF else None
            self._network.subscribe(0x700 + node_id, self._on_heartbeat)
        elif index == 0x6040:
            self._control(value)
        elif index == 0x6060 and value not in (0, CYCLIC_SYNCHRONOUS_VELOCITY):
            raise SdoAbortedError(ABORT_VALUE)
        self._written[index, subindex] = value

    def _check_communication(self, index, subindex, value):
        if subindex != 1:
            return
        now = self.value(index, 1)
        if not (now | value) & PDO_NOT_VALID and now != value:
            raise SdoAbortedError(ABORT_VALUE)  # a valid PDO keeps its id

    def _check_mapping(self, index, subindex, value):
        if self._nmt != "PRE-OPERATIONAL" or not self.value(index - 0x200, 1) & PDO_NOT_VALID:
            raise SdoAbortedError(ABORT_DEVICE_STATE)
        if subindex:
            if self.value(index, 0):
                raise SdoAbortedError(ABORT_DEVICE_STATE)  # number of entries first to 0
            self._check_entry(value, is_receive=index < 0x1800)
        elif sum(self.value(index, entry) & 0xFF for entry in range(1, value + 1)) > 64:
            raise SdoAbortedError(ABORT_PDO_TOO_LONG)

    def _check_entry(self, value, is_receive):
        index, subindex, bits = value >> 16, value >> 8 & 0xFF, value & 0xFF
        mapped = self.node.object_dictionary.get(index)
        can_map = mapped is not None and subindex == 0 and getattr(mapped, "pdo_mappable", False)
        can_map = can_map and len(mapped) == bits
        if not can_map or not (mapped.writable if is_receive else mapped.readable):
            raise SdoAbortedError(ABORT_CANNOT_MAP)

    # --- process data and motion

    def _on_rpdo(self, pdo_map):
        if self._nmt != "OPERATIONAL" or not pdo_map.enabled:
            return
        if 8 * len(pdo_map.data) < pdo_map.length:
            self.pdos_of_wrong_length += 1
            self.node.emcy.send(EMCY_PDO_LENGTH, 0x10)
        elif pdo_map.trans_type <= LAST_SYNCHRONOUS_TYPE:
            self._waiting[pdo_map.cob_id] = pdo_map
        else:
            self._take(pdo_map)

    def _take(self, pdo_map):
        for variable in pdo_map:
            self.node.set_data(variable.index, variable.subindex, variable.data)
        self._set_velocity()

    def _on_sync(self, _id, _data, time_s):
        if self._nmt != "OPERATIONAL":
            return
        self._check_heartbeat(time_s)
        periods = self._move(time_s)
        position = round(self.position)
        status_word = self.power.status_word
        for pdo_map in self.node.tpdo.values():
            if pdo_map.enabled and pdo_map.trans_type <= LAST_SYNCHRONOUS_TYPE:
                for variable in pdo_map:
                    variable.data = self.node.get_data(variable.index, variable.subindex)
                pdo_map.transmit()
        for pdo_map in self._waiting.values():
            self._take(pdo_map)
        self._waiting.clear()
        self.rows.append(
            (time_s, self.bus, self.node.id, self.value(0x6040), self.value(0x60FF), status_word,
             position, self.velocity, periods)
        )  # fmt: skip

    def _control(self, control_word):
        before = self.power.state
        self.power.command(control_word)
        after = self.power.state
        if before == cia402.FAULT != after:
            self.error = 0
            self.node.emcy.reset()
        if before == cia402.OPERATION_ENABLED != after != cia402.QUICK_STOP_ACTIVE:
            self.stops_without_ramp += self.velocity != 0
        self._set_velocity()

    def _set_velocity(self):
        if self.power.state == cia402.OPERATION_ENABLED:
            follows = self.value(0x6060) == CYCLIC_SYNCHRONOUS_VELOCITY
            largest = self.value(0x607F)
            told = self.value(0x60FF) + self.value(0x60B1)
            self.velocity = float(max(-largest, min(largest, told))) if follows else 0.0
        elif self.power.state != cia402.QUICK_STOP_ACTIVE:
            self.velocity = 0.0

    def _move(self, time_s):
        period_s = self.value(0x60C2, 1) * 10.0 ** self.value(0x60C2, 2)
        periods = self._periods.advance(time_s, period_s)
        self.position += self.velocity * periods * period_s
        if self.power.state == cia402.QUICK_STOP_ACTIVE:
            self._slow_down(self.value(0x6085) * periods * period_s)
        return periods

    def _slow_down(self, step):
        self.velocity = math.copysign(max(0.0, abs(self.velocity) - step), self.velocity)
        if self.velocity == 0.0 and self.value(0x605A) <= 4:
            self.power.stopped()

    def _lose_connection(self, emergency):
        """What 6007, abort connection option code, says: nothing, fault, power off or quick stop."""
        self.emergencies.append((emergency, self.power.state))
        self.node.emcy.send(emergency, 0x11)
        option = self.value(0x6007)
        if option == 1 and self.power.state in (cia402.OPERATION_ENABLED, cia402.QUICK_STOP_ACTIVE):
            self.error = emergency
            self.power.fail()
            self._set_velocity()
        elif option == 2:
            self._control(0x0000)
        elif option == 3:
            self._control(0x0002)
