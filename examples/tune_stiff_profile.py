#!/usr/bin/python3
"""Tunes T and d of the target dynamics on a stiff profile: simulates each pair, prints what became of it,
and names the best one.

usage: tune_stiff_profile.py [SCENE.yaml] [--T S...] [--d D...] [--min-phase-deg DEG]
                             [--max-tool-error-mm MM]

Best is the pair with the lowest peak force, and of those within 2 % of it the one that settles first. The
phase margin of its loop in the stiffest contact has to suffice, and its tool to stay near the path."""

import argparse
import concurrent.futures
import itertools
import pathlib
import re
import sys

import tactus

CONFIG = pathlib.Path(__file__).resolve().parents[1] / "config"
SCENES = CONFIG / "scenes" if CONFIG.is_dir() else pathlib.Path("/usr/share/tactus/scenes")
SCENE = SCENES / "scenario3_estimated.yaml"


def attempt(path, time_constant_s, damping):
    """What `tactus check` and a run say of the pair; None where it is unstable."""
    scene = tactus.Scene(path, set={"controller.time_constant_s": time_constant_s,
                                    "controller.damping": damping})
    try:
        # NaN, and so never the best, where check computes none
        margin_deg = min((loop["phase_margin_deg"] for loop in scene.check()["stability"]["loops"]),
                         default=float("nan"))
    except tactus.ConfigError as error:
        if not re.search(r"unstable \(.*\) in a contact of ", str(error)):
            raise
        return None
    run = tactus.simulate(scene)
    settling_s = max((contact["settling_s"] for contact in run.contacts), default=0.0)
    return {"T": time_constant_s, "d": damping, "margin_deg": margin_deg, "fault": run.fault,
            "peak_N": run.summary["peak_force_N"], "settling_s": settling_s,
            "tool_mm": 1e3 * run.summary["tcp_error_max_m"],
            # NaN, where the robot has no collision_capsules to know it by
            "unsensed_N": run.summary.get("unsensed_contact", {}).get("force_N", float("nan"))}


def best(results, min_phase_deg, max_tool_error_mm):
    fit = [one for one in results if one and not one["fault"]
           and one["margin_deg"] >= min_phase_deg and one["tool_mm"] <= max_tool_error_mm]
    if not fit:
        return None
    lowest_N = min(one["peak_N"] for one in fit)
    return min((one for one in fit if one["peak_N"] <= 1.02 * lowest_N), key=lambda one: one["settling_s"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", nargs="?", default=SCENE)
    parser.add_argument("--T", type=float, nargs="+", default=[0.05, 0.07, 0.1, 0.14, 0.2], metavar="S")
    parser.add_argument("--d", type=float, nargs="+", default=[0.4, 0.5, 0.7, 1.0], metavar="D")
    parser.add_argument("--min-phase-deg", type=float, default=30.0, metavar="DEG")
    parser.add_argument("--max-tool-error-mm", type=float, default=float("inf"), metavar="MM")
    arguments = parser.parse_args()
    pairs = list(itertools.product(arguments.T, arguments.d))
    try:
        if tactus.Scene(arguments.scene).variant == "none":
            print(f"{arguments.scene}: without force control there is nothing to tune, expected controller.variant",
                  file=sys.stderr)
            return 1
        # threads do, as a simulation lets others go on
        with concurrent.futures.ThreadPoolExecutor() as threads:
            results = list(threads.map(lambda pair: attempt(arguments.scene, *pair), pairs))
    except tactus.ConfigError as error:
        print(error, file=sys.stderr)
        return 1
    print(f"{'T, s':>6} {'d':>5} {'phase, deg':>10} {'peak, N':>8} {'settles, s':>10} {'tool, mm':>8} "
          f"{'unsensed, N':>11}")
    for (time_constant_s, damping), one in zip(pairs, results):
        figures = "refused: unstable" if one is None else (
            f"{one['margin_deg']:10.1f} {one['peak_N']:8.2f} {one['settling_s']:10.2f} {one['tool_mm']:8.1f} "
            f"{one['unsensed_N']:11.1f}"
            + (f" {one['fault']}" if one["fault"] else ""))
        print(f"{time_constant_s:6g} {damping:5g} {figures}")
    chosen = best(results, arguments.min_phase_deg, arguments.max_tool_error_mm)
    if chosen is None:
        print("none is fit")
        return 3
    if chosen["unsensed_N"] > 0.0:
        print(f"the best pushes with up to {chosen['unsensed_N']:.1f} N where no module is")
    print(f"best: T = {chosen['T']:g} s, d = {chosen['d']:g}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
