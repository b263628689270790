"""What the report needs of a log."""

import numpy as np
import tactus

from . import arm
from .errors import InputError, first_line

NEEDED = ("t_s", "force_sensor_N", "stiffness_N_per_m", "dq", "tool_error_x_m", "tool_error_y_m", "tool_error_z_m",
          "q_measured", "contact_position_m", "contact_dir_x", "contact_dir_y", "contact_dir_z")


def read(path):
    """Members of a Run, of all its logs. Raises InputError."""
    log = open_log(path)
    fields = all_fields(path, log)
    dq = fields["dq"].T.copy()
    errors = [fields[f"tool_error_{axis}_m"] for axis in "xyz"]
    return {"time_s": fields["t_s"], "force_N": np.max(of_each_module(fields["force_sensor_N"]), axis=0),
            "stiffness_N_per_m": fields["stiffness_N_per_m"], "joint_jerk": jerk(fields["t_s"], dq),
            "joint_speed_squared": np.sum(np.square(dq), axis=0),
            "tool_error_m": np.sqrt(np.sum(np.square(errors), axis=0)),
            "sources": log.sources, "overrides": log.overrides,
            "is_cut_off": log.is_cut_off, **of_modules(log, fields)}


def open_log(path):
    try:
        log = tactus.read_log(path)
    except tactus.Error as error:
        raise InputError(first_line(error)) from error
    for field in NEEDED:
        if not np.isfinite(log[field]).all():
            raise InputError(f"{path}: {field}: a number that is not finite, expected none in a log")
    return log


def all_fields(path, log):
    """Each field that is needed, of run.ulg and of those before it, run.1.ulg the newest: copies, so that no
    log is kept whole."""
    parts = [{field: log[field].copy() for field in NEEDED}]
    while (older := path.with_name(f"run.{len(parts)}.ulg")).is_file():
        before = open_log(older)
        if before.infos.get("run") != log.infos.get("run"):
            break
        parts.insert(0, {field: before[field].copy() for field in NEEDED})
    fields = {field: np.concatenate([part[field] for part in parts]) for field in NEEDED}
    if len(fields["t_s"]) < 2:
        raise InputError(f"{path}: fewer than two cycles, expected those of a run")
    return fields


def of_each_module(field):
    return list(np.atleast_2d(field.T).copy())


def of_modules(log, fields):
    """The members of a Run that speak of several modules; none where there are not."""
    forces_N = of_each_module(fields["force_sensor_N"])
    if len(log.modules) < 2 or len(log.modules) != len(forces_N):
        return {}
    directions = [of_each_module(fields[f"contact_dir_{axis}"]) for axis in "xyz"]
    return {"modules": [printable(link) for link in log.modules], "forces_N": forces_N,
            "positions_m": of_each_module(fields["contact_position_m"]),
            "directions": [np.column_stack(xyz) for xyz in zip(*directions)],
            "q": fields["q_measured"], "arm": arm.read_arm(log)}


def printable(text):
    """Of a text that may be no UTF-8."""
    return text.encode("utf-8", "replace").decode("utf-8")


def jerk(time_s, velocities):
    """As long as the time: the first and the last cycle have none. Cycles are evenly spaced."""
    inner = np.diff(velocities, 2, axis=1) / (time_s[1] - time_s[0]) ** 2
    return np.pad(np.sqrt(np.sum(np.square(inner), axis=0)), 1)
