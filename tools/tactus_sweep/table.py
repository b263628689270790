"""The table of all runs."""

import csv
import io
import math

from tactus._sweep import ALL_FIGURES

NAME = "table.csv"


def table_text(study, plan, rows):
    """CSV, by the number of the run: the same bytes whoever computed them, in whatever order."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    keys = [axis.key for axis in study.axes]
    writer.writerow(["run", "scene", *keys, "outcome", "reason", *ALL_FIGURES, "is_within", "objective"])
    for row in rows:
        settings = dict(setting.split("=", 1) for setting in plan.settings(row["run"]))
        writer.writerow([row["run"], scene_name(study, plan, row), *(settings[key] for key in keys),
                         row["outcome"], row["reason"], *(cell(row.get(name)) for name in ALL_FIGURES),
                         int(row["is_within"]), cell(row["objective"])])
    return out.getvalue()


def scene_name(study, plan, row):
    return study.scenes[plan.place(row["run"])[0]][1]


def cell(value):
    """As short as brings back the same bits; nothing of what is not known."""
    if value is None or value == math.inf:
        return ""
    return repr(value)
