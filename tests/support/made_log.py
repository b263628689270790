"""Logs whose numbers are known: a cycle has the fields that docs/log.md lists, the rest is as ULog has it
(https://docs.px4.io/main/en/dev_log/ulog_file_format)."""

import pathlib
import re
import struct

import numpy as np

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/log.md"
FIELDS = re.findall(r"^\| `(\w+)` \|[^|]*\| (1|joint|task|module) \|", PAGE.read_text(encoding="utf-8"), re.M)
UNSIGNED = {"fault", "mode", "tactile_sequence", "missed_cycles"}
HEADER = b"ULog\x01\x12\x35\x01" + bytes(8)
CYCLE_ID = 7


def made_log(columns, modules=1, without=()):
    """The bytes of a log of 2 joints and as many cycles as columns["t_s"]; what is not named is zero."""
    entries = {"1": 1, "task": 1, "joint": 2, "module": modules}
    fields = [(name, number_type(name), (entries[what],) if entries[what] > 1 else ())
              for name, what in FIELDS if not name.endswith("_name") and name not in without]
    head = [("size", "<u2"), ("kind", "S1"), ("id", "<u2"), ("timestamp", "<u8")]
    cycles = np.zeros(len(columns["t_s"]), head + fields)
    cycles["size"], cycles["kind"], cycles["id"] = cycles.dtype.itemsize - 3, b"D", CYCLE_ID
    for name in columns.keys() - set(without):
        cycles[name] = columns[name]
    return HEADER + definitions(fields) + cycles.tobytes()


def number_type(name):
    return "<u8" if name in UNSIGNED else "<i8" if name.endswith("_ns") else "<f8"


def definitions(fields):
    names = {"<u8": "uint64_t", "<i8": "int64_t", "<f8": "double"}
    text = "".join(f"{names[kind]}{f'[{shape[0]}]' if shape else ''} {name};" for name, kind, shape in fields)
    return (message(b"B", bytes(40)) + message(b"F", b"cycle:uint64_t timestamp;" + text.encode())
            + message(b"A", struct.pack("<BH", 0, CYCLE_ID) + b"cycle"))


def message(kind, payload):
    return struct.pack("<Hc", len(payload), kind) + payload
