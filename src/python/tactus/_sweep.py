"""The runs of `tactus sweep`, wherever they are computed: in its worker processes, which start as
`python3 -m tactus._sweep`, or on workers of Dask.

A worker process reads lines of JSON, the plan and then batches of run numbers, and answers with a line a run;
its first one says which tactus it is.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import signal
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _core
from .errors import ConfigError

Files = list[tuple[bytes, bytes]]  # path and text each, the scene first
Row = dict[str, Any]

# Of a run's summary, and what its contacts have at most.
FIGURES = ("peak_force_N", "final_force_N", "tcp_error_max_m", "tcp_error_rms_m", "tcp_error_final_m",
           "tcp_rotation_error_max_rad", "tcp_rotation_error_rms_rad", "tcp_rotation_error_final_rad",
           "peak_joint_speed_squared", "joints_at_limit_cycles", "stiffness_final_N_per_m",
           "stiffness_at_peak_N_per_m")
OF_CONTACTS = ("settling_s", "time_above_s", "swing_N")
ALL_FIGURES = (*FIGURES, "contacts", *OF_CONTACTS, "module_losses", "path_left_s", "unsensed_force_N")


class OtherVersion(Exception):
    """A worker has another tactus than the sweep."""


@dataclass(frozen=True)
class Plan:
    """All runs of a study: each scene with each choice of each part, scenes outermost."""

    scenes: list[Files]
    fixed: list[str]  #: KEY=VALUE, for all runs
    parts: list[list[list[str]]]  #: grid, points, disturbances: the settings of each of their choices

    @property
    def runs(self) -> int:
        count = len(self.scenes)
        for part in self.parts:
            count *= len(part)
        return count

    def place(self, run: int) -> tuple[int, ...]:
        """Numbers of scene, grid, point and disturbance."""
        places = []
        for part in reversed(self.parts):
            run, place = divmod(run, len(part))
            places.append(place)
        return (run, *reversed(places))

    def settings(self, run: int) -> list[str]:
        _, *places = self.place(run)
        settings = list(self.fixed)
        for part, place in zip(self.parts, places):
            settings += part[place]
        return settings

    def files(self, run: int) -> Files:
        return self.scenes[self.place(run)[0]]

    def as_json(self) -> dict[str, Any]:
        scenes = [[[as_text(path), as_text(text)] for path, text in files] for files in self.scenes]
        return {"scenes": scenes, "fixed": self.fixed, "parts": self.parts}

    @staticmethod
    def from_json(plan: dict[str, Any]) -> Plan:
        scenes = [[(as_bytes(path), as_bytes(text)) for path, text in files] for files in plan["scenes"]]
        return Plan(scenes, plan["fixed"], plan["parts"])


def as_text(data: bytes) -> str:
    return data.decode("utf-8", "surrogateescape")


def as_bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogateescape")


@functools.cache
def identity() -> dict[str, str]:
    """Of this tactus: two that differ need not compute the same."""
    build = hashlib.sha256(Path(_core.__file__).read_bytes()).hexdigest()[:16]
    return {"version": _core.VERSION, "build": build}


def load(files: Files, settings: list[str]) -> _core.Scene:
    return _parsed(tuple(files)).load([as_bytes(setting) for setting in settings])


@functools.lru_cache(maxsize=64)
def _parsed(files: tuple[tuple[bytes, bytes], ...]) -> _core.StudyScene:
    """Parsing takes most of the time of loading, and more than a short run."""
    return _core.study_scene(files)


def run(files: Files, settings: list[str]) -> Row:
    """Outcome and figures; what goes wrong is an outcome, too."""
    try:
        summary = json.loads(_core.figures(load(files, settings)))
    except ConfigError as error:
        return {"outcome": "refused", "reason": str(error)}
    except Exception as error:  # whatever it is, the other runs go on
        return {"outcome": "failed", "reason": f"{type(error).__name__}: {error}"}
    reason = summary["fault"]["description"] if summary["fault"] else ""
    return {"outcome": summary["outcome"], "reason": reason, **_figures(summary)}


def _figures(summary: dict[str, Any]) -> Row:
    contacts = summary["contacts"]
    figures = {name: summary.get(name) for name in FIGURES}
    further = summary.get("further_contacts", 0)
    figures["contacts"] = len(contacts) + further
    for name in OF_CONTACTS:
        values = [contact.get(name) for contact in contacts] + [None] * min(further, 1)
        figures[name] = _largest(values)
    figures["module_losses"] = len(summary.get("module_losses", [])) + summary.get("further_module_losses", 0)
    figures["path_left_s"] = summary.get("path_left_s")
    figures["unsensed_force_N"] = summary.get("unsensed_contact", {}).get("force_N")
    return figures


def _largest(values: list[float | None]) -> float | None:
    """Unknown where one of them is: it may be the largest."""
    known = [value for value in values if value is not None]
    return max(known) if known and len(known) == len(values) else None


def run_batch(wanted: dict[str, str], jobs: list[tuple[int, Files, list[str]]]) -> list[Row]:
    """On a worker of Dask: rows of the runs, each with its number."""
    if identity() != wanted:
        raise OtherVersion(f"tactus {identity()['version']}, build {identity()['build']}")
    return [{"run": number, **run(files, settings)} for number, files, settings in jobs]


def _answer(plan: Plan, numbers: list[int]) -> None:
    for number in numbers:
        _say({"run": number, **run(plan.files(number), plan.settings(number))})


def _say(answer: Row | dict[str, str]) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


def main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the sweep, which then closes the pipe
    try:
        _say(identity())
        plan = Plan.from_json(json.loads(sys.stdin.readline()))
        for line in sys.stdin:
            _answer(plan, json.loads(line))
    except (BrokenPipeError, ValueError):  # the sweep is gone, perhaps within a line
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    main()
