"""What the report needs of a log."""

import numpy as np
import tactus

from . import arm
from .errors import InputError, first_line

NEEDED = ("t_s", "force_sensor_N", "stiffness_N_per_m", "dq", "tool_error_x_m", "tool_error_y_m", "tool_error_z_m",
          "q_measured", "contact_position_m", "contact_dir_x", "contact_dir_y", "contact_dir_z")


def read(path):
    """Members of a Run: copies, so that a run does not keep its whole log. Raises InputError."""
    log = open_log(path)
    dq = log["dq"].T.copy()
    errors = [log[f"tool_error_{axis}_m"] for axis in "xyz"]
    return {"time_s": log["t_s"].copy(), "force_N": np.max(of_each_module(log["force_sensor_N"]), axis=0),
            "stiffness_N_per_m": log["stiffness_N_per_m"].copy(), "joint_jerk": jerk(log["t_s"], dq),
            "joint_speed_squared": np.sum(np.square(dq), axis=0),
            "tool_error_m": np.sqrt(np.sum(np.square(errors), axis=0)), **of_modules(log)}


def open_log(path):
    try:
        log = tactus.read_log(path)
    except tactus.Error as error:
        raise InputError(first_line(error)) from error
    if log.cycles < 2:
        raise InputError(f"{path}: fewer than two cycles, expected those of a run")
    for field in NEEDED:
        if not np.isfinite(log[field]).all():
            raise InputError(f"{path}: {field}: a number that is not finite, expected none in a log")
    return log


def of_each_module(field):
    return list(np.atleast_2d(field.T).copy())


def of_modules(log):
    """The members of a Run that speak of several modules; none where there are not."""
    forces_N = of_each_module(log["force_sensor_N"])
    if len(log.modules) < 2 or len(log.modules) != len(forces_N):
        return {}
    directions = [of_each_module(log[f"contact_dir_{axis}"]) for axis in "xyz"]
    return {"modules": [printable(link) for link in log.modules], "forces_N": forces_N,
            "positions_m": of_each_module(log["contact_position_m"]),
            "directions": [np.column_stack(xyz) for xyz in zip(*directions)],
            "q": log["q_measured"].copy(), "arm": arm.read_arm(log)}


def printable(text):
    """Of a text that may be no UTF-8."""
    return text.encode("utf-8", "replace").decode("utf-8")


def jerk(time_s, velocities):
    """As long as the time: the first and the last cycle have none. Cycles are evenly spaced."""
    inner = np.diff(velocities, 2, axis=1) / (time_s[1] - time_s[0]) ** 2
    return np.pad(np.sqrt(np.sum(np.square(inner), axis=0)), 1)
