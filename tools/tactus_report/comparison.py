"""The table "paper, reference, ours": numbers of others from comparison.json, ours from the runs."""

import dataclasses
import json
import pathlib

import numpy as np

DATA = pathlib.Path(__file__).with_name("comparison.json")


@dataclasses.dataclass
class Row:
    quantity: str
    paper: str
    reference: str
    ours: str  # "scenario1_none missing" where a run is not there
    difference: str  # of ours from the reference, in percent


def stiffness_on_band(run):
    """Median estimate while scenario 2 rests on the soft band, before the profile is reached."""
    on_band = (run.time_s >= 6.5) & (run.time_s <= 7.5)
    return float(np.median(run.stiffness_N_per_m[on_band])) if on_band.any() else None


def reduction_percent(before, after):
    return [100.0 * (1.0 - after / before)] if before else [None]


DERIVED = {
    "stiffness_on_band": stiffness_on_band,
    "tcp_error_max_mm": lambda run: scaled(run.summary["tcp_error_max_m"], 1e3),
}


def scaled(value, factor):
    return None if value is None else factor * value


def read_data():
    return json.loads(DATA.read_text(encoding="utf-8"))


def compare(runs):
    """The rows that any of the runs belongs to."""
    return [compare_row(row, runs) for row in read_data()["rows"]
            if any(key.split(":")[0] in runs for key in row["ours"])]


def compare_row(row, runs):
    ours, difference = "", ""
    keys = [key.split(":") for key in row["ours"]]
    missing = [scene for scene, _ in keys if scene not in runs]
    if missing:
        ours = f"{missing[0]} missing"
    else:
        values = [measure(runs[scene], name) for scene, name in keys]
        if row.get("combine") == "reduction_percent" and None not in values:
            values = reduction_percent(*values)
        if None not in values:
            ours = row["format"].format(*values)
            difference = differences(values, row.get("reference_values", []))
            if any(runs[scene].overrides for scene, _ in keys):
                ours += ", with --set"
    return Row(row["quantity"], row["paper"], row["reference"], ours, difference)


def measure(run, name):
    return DERIVED[name](run) if name in DERIVED else run.summary[name]


def differences(values, references):
    percent = [100.0 * (value / reference - 1.0) for value, reference in zip(values, references)]
    # + 0.0: no minus before a zero.
    return ", ".join(f"{round(value, 1) + 0.0:+.1f} %" for value in percent)


def as_markdown(rows):
    """The table for a terminal or a Markdown page: columns aligned."""
    cells = [["Quantity", "Paper", "Reference", "Ours"]]
    cells += [[row.quantity, row.paper, row.reference, row.ours] for row in rows]
    widths = [max(len(row[column]) for row in cells) for column in range(len(cells[0]))]
    lines = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |"
             for row in cells]
    lines.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(lines)
