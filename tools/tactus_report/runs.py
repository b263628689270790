"""Run folders: DIR/<run>/{run.ulg,summary.json}, as `tactus simulate -o DIR` writes them; a run has the
name of its scene or the one that --name gave it."""

import collections
import dataclasses
import json
import pathlib
import sys

import numpy as np

from . import logs
from .errors import InputError, first_line

SUMMARY_NUMBERS = ("peak_force_N", "final_force_N", "tcp_error_max_m", "tcp_error_rms_m",
                   "tcp_error_final_m", "peak_joint_speed_squared", "joints_at_limit_cycles",
                   "stiffness_at_peak_N_per_m", "real_time_factor")
STEP_TIMES = ("median", "p99")
# That summaries of older versions do not have.
FIGURES_OF_CONTACTS = ("rest_force_N", "swing_N", "stiffness_N_per_m", "tcp_error_max_m", "null_space_share",
                       "task_space_share", "time_constant_s", "damping")


@dataclasses.dataclass
class Run:
    name: str  # its folder's, and as much of the path before as tells it from others
    scene: str
    summary: dict  # checked: every name above is there, a finite number or None
    time_s: np.ndarray
    force_N: np.ndarray  # F_sen, of several modules the largest
    stiffness_N_per_m: np.ndarray  # c
    joint_jerk: np.ndarray  # norm of the second difference of the command; mixed likewise
    joint_speed_squared: np.ndarray  # of the command; m/s and rad/s mixed, as in the paper
    tool_error_m: np.ndarray  # |w_d - w| of the real arm
    sources: dict  # of each file that it was made of its text, the scene first
    overrides: dict  # the values of --set
    is_cut_off: bool  # the log's file ends within a record
    # Of each tactile module, in the order of robot.yaml; of logs of one: nothing.
    modules: list = dataclasses.field(default_factory=list)  # their links
    forces_N: list = dataclasses.field(default_factory=list)
    positions_m: list = dataclasses.field(default_factory=list)  # of the contact along the link
    directions: list = dataclasses.field(default_factory=list)  # one row a cycle, frame of the module
    q: np.ndarray = None  # as measured, one row a cycle
    arm: tuple = None  # chain, covers, obstacles

    @property
    def set_text(self):
        """What --set changed of its scene."""
        return ", ".join(f"{key}={value}" for key, value in self.overrides.items())

    @property
    def end_text(self):
        """Of a log that ends before its run, whose summary is of the whole run."""
        log = self.summary.get("log") or {}
        if not self.is_cut_off and log.get("state") != "stopped":
            return ""
        reason = "" if self.is_cut_off else f" ({log.get('reason', 'it was stopped')})"
        return f"{self.name}: log ends at {self.time_s[-1]:.3f} s{reason}, before the run"


def load_runs(folders):
    """All runs in the folders, in their order. Raises InputError."""
    paths = []
    for folder in folders:
        if not pathlib.Path(folder).is_dir():
            raise InputError(f"{folder}: no such folder, expected what `tactus simulate -o` wrote")
        paths += [path.parent for path in sorted(pathlib.Path(folder).glob("*/summary.json"))]
    if not paths:
        raise InputError(f"{', '.join(map(str, folders))}: no run found, expected "
                         "<scene>/summary.json as `tactus simulate -o` writes it")
    return [load_run(path, name) for path, name in zip(paths, run_names(paths))]


def run_names(paths):
    """The last parts of each path, as few as make all names different."""
    paths = [path.resolve() for path in paths]
    for path, count in collections.Counter(paths).items():
        if count > 1:
            raise InputError(f"{path}: is there twice, expected once")
    names = [path.name for path in paths]
    length = 1
    while len(set(names)) < len(names):
        length += 1
        counts = collections.Counter(names)
        names = ["/".join(path.parts[-length:]) if counts[name] > 1 else name
                 for path, name in zip(paths, names)]
    return names


def by_scene(runs):
    """One run a scene: as the file has it before one with --set, in a folder of its name, or else the first."""
    chosen = {}
    for run in sorted(runs, key=lambda run: (bool(run.overrides), run.name.split("/")[-1] != run.scene)):
        chosen.setdefault(run.scene, run)
    return chosen


def of_one_scene(runs):
    """Lists of several runs of one scene."""
    groups = collections.defaultdict(list)
    for run in runs:
        groups[run.scene].append(run)
    return [group for _, group in sorted(groups.items()) if len(group) > 1]


def load_run(folder, name):
    summary = read_summary(folder / "summary.json")
    log = folder / "run.ulg"
    if not log.is_file():
        raise InputError(f"{log}: missing, expected the log beside summary.json")
    return Run(name, summary["scene"], summary, **logs.read(log))


def read_summary(path):
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: not readable as JSON: {first_line(error)}") from error
    if not isinstance(summary, dict):
        raise InputError(f"{path}: not an object, expected the summary of a run")
    for key in ("scene", "outcome"):
        if not isinstance(summary.get(key), str):
            raise InputError(f"{path}: {key}: missing or no text, expected a name")
    for key in SUMMARY_NUMBERS:
        check_number(path, key, summary)
    times = summary.get("step_time_ns")
    if not isinstance(times, dict):
        raise InputError(f"{path}: step_time_ns: missing or no object, expected min to max")
    for key in STEP_TIMES:
        check_number(path, key, times)
    check_fault(path, summary.get("fault"))
    check_unsensed(path, summary.get("unsensed_contact"))
    check_contacts(path, summary.get("contacts", []))
    if not isinstance(summary.get("log"), dict | None):
        raise InputError(f"{path}: log: no object, expected its state")
    return summary


def check_contacts(path, contacts):
    if not isinstance(contacts, list):
        raise InputError(f"{path}: contacts: no list, expected one of contacts")
    for number, contact in enumerate(contacts):
        place = f"{path}: contacts[{number}]"
        if not isinstance(contact, dict) or not isinstance(contact.get("tactile_module"), str):
            raise InputError(f"{place}.tactile_module: missing or no text, expected a link")
        for key in ("start_s", "end_s", "peak_force_N", "settling_s"):
            check_number(place, key, contact)
            if contact[key] is None:
                raise InputError(f"{place}: {key}: null, expected a finite number")
        for key in FIGURES_OF_CONTACTS:
            if key in contact:
                check_number(place, key, contact)
        fit = contact.get("contact_stiffness_N_per_m")
        if fit is None:
            continue
        if not isinstance(fit, dict):
            raise InputError(f"{place}.contact_stiffness_N_per_m: no object, expected value, low and high")
        for key in ("value", "low", "high"):
            check_number(f"{place}.contact_stiffness_N_per_m", key, fit)
            if fit[key] is None:
                raise InputError(f"{place}.contact_stiffness_N_per_m: {key}: null, expected a finite number")


def check_unsensed(path, contact):
    """Absent without capsules; link, obstacle and time are null where nothing touched."""
    if contact is None:
        return
    if not isinstance(contact, dict):
        raise InputError(f"{path}: unsensed_contact: no object, expected force_N to t_s")
    for key in ("force_N", "obstacle", "t_s"):
        check_number(path, key, contact)
    if contact["force_N"] and not isinstance(contact.get("link"), str):
        raise InputError(f"{path}: unsensed_contact.link: missing or no text, expected a name")


def check_fault(path, fault):
    """Absent or null: the run had none."""
    if fault is None:
        return
    if not isinstance(fault, dict):
        raise InputError(f"{path}: fault: no object, expected name to description, or null")
    for key in ("name", "description"):
        if not isinstance(fault.get(key), str):
            raise InputError(f"{path}: fault.{key}: missing or no text, expected words")
    for key in ("joint", "bus", "unit"):
        if not isinstance(fault.get(key, 0), str | None):
            raise InputError(f"{path}: fault.{key}: missing or no text, expected a name or null")
    for key in ("time_s", "value", "limit"):
        check_number(path, key, fault)


def check_number(path, key, values):
    """A number may be null where a scene lacks the stage that would make it."""
    value = values.get(key, "missing")
    if value is None:
        return
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or not abs(value) <= sys.float_info.max:
        raise InputError(f"{path}: {key}: {str(value)[:40]}, expected a finite number or null")
