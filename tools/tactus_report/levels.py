"""The acceleration level beside the velocity level: force, jerk, and the margins of `tactus check`."""

import json

import numpy as np
import tactus
from tactus._sweep import as_bytes, load

PAIRS = [("scenario1_multi_space", "scenario1_acceleration"),
         ("scenario2_estimated", "scenario2_acceleration"),
         ("scenario3_estimated", "scenario3_acceleration")]
HEADS = ["Run", "Peak force, N", "Final force, N", "Joint jerk rms, rad/s³", "Joint jerk peak, rad/s³",
         "Stable to c_e/c", "Phase margin, degrees"]


def shown(by_scene):
    """The scenes of pairs that have a run of the acceleration level."""
    return [scene for pair in PAIRS if pair[1] in by_scene for scene in pair if scene in by_scene]


def rows(by_scene):
    return [[scene + (", with --set" if by_scene[scene].overrides else ""), *figures(by_scene[scene]),
             *margins(by_scene[scene])] for scene in shown(by_scene)]


def figures(run):
    forces = [run.summary["peak_force_N"], run.summary["final_force_N"]]
    jerks = [float(np.sqrt(np.mean(np.square(run.joint_jerk)))), float(run.joint_jerk.max())]
    return (["" if force is None else f"{force:.2f}" for force in forces]
            + [f"{jerk:.0f}" for jerk in jerks])


def margins(run):
    """Those of the least stable loop, of the files that the log holds and --set; empty without a loop."""
    files = [(as_bytes(path), as_bytes(text)) for path, text in run.sources.items()]
    settings = [f"{key}={value}" for key, value in run.overrides.items()]
    try:
        return least_stable(json.loads(load(files, settings).check())["stability"]["loops"])
    except (tactus.Error, LookupError, TypeError, ValueError):
        return ["", ""]


def least_stable(loops):
    return [f"{min(loop['largest_stiffness_ratio'] for loop in loops):.2f}",
            f"{min(loop['phase_margin_deg'] for loop in loops):.1f}"]
