"""The page of `tactus bench -o DIR`: goals, figures and tables of DIR's report.json and CSV files."""

import csv
import html
import json

from .document import html_page, table
from .errors import InputError, first_line
from .figures import as_figure
from .series_figure import Series, series_figure

PLAN = "report.json"


def is_bench(folder):
    return (folder / PLAN).is_file()


def build_page(folder):
    """Raises InputError."""
    try:
        sections = json.loads((folder / PLAN).read_text(encoding="utf-8"))["sections"]
        tables = {name: read_table(folder / f"{name}.csv")
                  for name in ["goals"] + [name for section in sections for name in section["tables"]]}
        body = ["<h1>Error against run time</h1>"]
        if tables["goals"]:
            body += ["<h2>Goals</h2>", table_of(tables["goals"])]
        for number, section in enumerate(sections):
            body += section_body(number, section, tables)
    except (KeyError, TypeError, AttributeError, ValueError, RecursionError) as error:
        raise InputError(f"{folder}: not what `tactus bench -o` wrote: {type(error).__name__}: "
                         f"{first_line(error)}") from error
    return html_page("Tactus: error against run time", body)


def read_table(path):
    """A dict a row, texts as they are in the file."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def section_body(number, section, tables):
    body = [f"<h2>{html.escape(section['title'])}</h2>", f"<p>{html.escape(section['text'])}</p>"]
    for place, plot in enumerate(section["plots"]):
        name = f"figure-{number}-{place}"
        series = [Series(entry["label"], *points(tables[plot["table"]], plot, entry["where"]))
                  for entry in plot["series"]]
        drawing = series_figure(name, series, (plot["x_label"], plot["y_label"]),
                                (plot["x_scale"], plot["y_scale"]), plot["has_lines"])
        body.append(as_figure(name, drawing, plot["title"], plot["note"]))
    for name in section["tables"]:
        body.append(f"<details><summary>{html.escape(name)}.csv</summary>\n{table_of(tables[name])}"
                    "</details>")
    return body


def points(rows, plot, where):
    """x and y of the rows that match; what was not measured is NaN."""
    chosen = [row for row in rows if all(matches(row[key], value) for key, value in where.items())]
    return [[float(row[plot[axis]] or "nan") for row in chosen] for axis in "xy"]


def matches(cell, value):
    return cell == value if isinstance(value, str) else cell != "" and float(cell) == value


def table_of(rows):
    heads = list(rows[0]) if rows else []
    return table(heads, [[shortened(row[head]) for head in heads] for row in rows], "bench")


def shortened(cell):
    try:
        return f"{float(cell):.4g}"
    except ValueError:
        return cell
