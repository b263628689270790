"""The object dictionary of a CiA 402 drive for cyclic synchronous velocity: what a data sheet lists.

Objects, types, access and power-on values as in CiA 301 and CiA 402-2. The process data objects
come up as a drive comes out of its box: another mapping than the master wants, so that it has to
write its own.
"""
from canopen.objectdictionary import ODArray, ODRecord, ODVariable, ObjectDictionary
from canopen.objectdictionary.datatypes import (
    INTEGER8,
    INTEGER16,
    INTEGER32,
    UNSIGNED8,
    UNSIGNED16,
    UNSIGNED32,
    VISIBLE_STRING,
)

CYCLIC_SYNCHRONOUS_VELOCITY = 9
PDO_NOT_VALID = 0x80000000
MAPPABLE = {0x603F, 0x6040, 0x6041, 0x6060, 0x6061, 0x6064, 0x606C, 0x60B1, 0x60FF}

# index, name, type, access, value at power-on
VARIABLES = [
    (0x1000, "Device type", UNSIGNED32, "const", 0x00020192),
    (0x1001, "Error register", UNSIGNED8, "ro", 0),
    (0x1005, "COB-ID SYNC", UNSIGNED32, "rw", 0x80),
    (0x1006, "Communication cycle period", UNSIGNED32, "rw", 0),
    (0x1008, "Manufacturer device name", VISIBLE_STRING, "const", "Peer drive"),
    (0x1017, "Producer heartbeat time", UNSIGNED16, "rw", 0),
    (0x6007, "Abort connection option code", INTEGER16, "rw", 1),
    (0x603F, "Error code", UNSIGNED16, "ro", 0),
    (0x6040, "Controlword", UNSIGNED16, "rw", 0),
    (0x6041, "Statusword", UNSIGNED16, "ro", 0),
    (0x605A, "Quick stop option code", INTEGER16, "rw", 2),
    (0x605B, "Shutdown option code", INTEGER16, "rw", 0),
    (0x605C, "Disable operation option code", INTEGER16, "rw", 1),
    (0x605D, "Halt option code", INTEGER16, "rw", 1),
    (0x605E, "Fault reaction option code", INTEGER16, "rw", 2),
    (0x6060, "Modes of operation", INTEGER8, "rw", 0),
    (0x6061, "Modes of operation display", INTEGER8, "ro", 0),
    (0x6064, "Position actual value", INTEGER32, "ro", 0),
    (0x6065, "Following error window", UNSIGNED32, "rw", 0xFFFFFFFF),
    (0x6066, "Following error time out", UNSIGNED16, "rw", 0),
    (0x606C, "Velocity actual value", INTEGER32, "ro", 0),
    (0x607F, "Max profile velocity", UNSIGNED32, "rw", 0xFFFFFFFF),
    (0x6080, "Max motor speed", UNSIGNED32, "rw", 0xFFFFFFFF),
    (0x6083, "Profile acceleration", UNSIGNED32, "rw", 10_000_000),
    (0x6084, "Profile deceleration", UNSIGNED32, "rw", 10_000_000),
    (0x6085, "Quick stop deceleration", UNSIGNED32, "rw", 10_000_000),
    (0x60B1, "Velocity offset", INTEGER32, "rw", 0),
    (0x60B2, "Torque offset", INTEGER16, "rw", 0),
    (0x60FF, "Target velocity", INTEGER32, "rw", 0),
    (0x6502, "Supported drive modes", UNSIGNED32, "ro", 1 << (CYCLIC_SYNCHRONOUS_VELOCITY - 1)),
]


def _variable(index, subindex, name, kind, access, value):
    variable = ODVariable(name, index, subindex)
    variable.data_type = kind
    variable.access_type = access
    variable.default = value
    variable.pdo_mappable = index in MAPPABLE
    return variable


def _group(group, index, members):
    """Members: subindex, name, type, access, value; subindex 0 is put in front."""
    count = max(subindex for subindex, *_ in members)
    group.add_member(_variable(index, 0, "Highest sub-index", UNSIGNED8, "const", count))
    for subindex, *rest in members:
        group.add_member(_variable(index, subindex, *rest))
    return group


def _process_data_object(number, is_receive, node_id):
    """Communication and mapping record; all are valid at power-on and sent or taken at any time.
    RPDOs have no event timer, as drives may be without it."""
    communication, mapping = (0x1400, 0x1600) if is_receive else (0x1800, 0x1A00)
    cob_id = (0x200 if is_receive else 0x180) + 0x100 * number + node_id
    word = 0x60400010 if is_receive else 0x60410010
    name = "RPDO" if is_receive else "TPDO"
    record = ODRecord(f"{name}{number + 1} communication", communication + number)
    members = [
        (1, "COB-ID", UNSIGNED32, "rw", cob_id),
        (2, "Transmission type", UNSIGNED8, "rw", 255),
    ]
    if not is_receive:
        members += [(3, "Inhibit time", UNSIGNED16, "rw", 0), (5, "Event timer", UNSIGNED16, "rw", 0)]
    yield _group(record, communication + number, members)

    array = ODArray(f"{name}{number + 1} mapping", mapping + number)
    array.add_member(_variable(mapping + number, 0, "Number of entries", UNSIGNED8, "rw", 1))
    for entry in range(1, 9):
        value = word if entry == 1 else 0
        array.add_member(_variable(mapping + number, entry, f"Entry {entry}", UNSIGNED32, "rw", value))
    yield array


def drive_object_dictionary(node_id):
    dictionary = ObjectDictionary()
    for index, *rest in VARIABLES:
        dictionary.add_object(_variable(index, 0, *rest))
    dictionary.add_object(_variable(0x1014, 0, "COB-ID EMCY", UNSIGNED32, "rw", 0x80 + node_id))
    heartbeat = [(1, "Consumer heartbeat time 1", UNSIGNED32, "rw", 0)]
    dictionary.add_object(_group(ODArray("Consumer heartbeat time", 0x1016), 0x1016, heartbeat))
    identity = [
        (1, "Vendor", UNSIGNED32, "const", 0x402),
        (2, "Product", UNSIGNED32, "const", 1),
        (3, "Revision", UNSIGNED32, "const", 1),
        (4, "Serial number", UNSIGNED32, "const", node_id),
    ]
    dictionary.add_object(_group(ODRecord("Identity", 0x1018), 0x1018, identity))
    period = [(1, "Value", UNSIGNED8, "rw", 1), (2, "Index", INTEGER8, "rw", -3)]
    dictionary.add_object(_group(ODRecord("Interpolation time period", 0x60C2), 0x60C2, period))
    for number in range(4):
        for is_receive in (True, False):
            for group in _process_data_object(number, is_receive, node_id):
                dictionary.add_object(group)
    return dictionary
