#!/usr/bin/python3
"""The paper's scenes on the daemon, over vcan, in virtual time, against `tactus simulate`.

usage: scenes_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep] [--all]

One of the scenes, or --all, which takes seven minutes and more."""

import sys
import unittest

from machine import SCENES, TIMEOUT_S, Build, summary

CYCLES = 13000
# Samples of the module meet the arm's motion in one of four phases, as chance started the daemon.
# Those that `simulate` does not have change its peak by less than 0.6 %, but by up to 3.31 % where the
# paper's law estimates the stiffness while the force rises.
DEVIATION, DEVIATION_ESTIMATED_PEAK = 0.01, 0.035
STOPPING_CYCLES = 40  # until the drives have followed the last setpoint and are off


class Scenes(unittest.TestCase):
    def test_scenes_as_simulated(self):
        runs = sorted(path.parent for path in results.glob("*/summary.json"))
        self.assertEqual(len(runs), len(list(SCENES.glob("scenario*.yaml"))) if every else 1)
        table = []
        for run in runs:
            with self.subTest(run.name):
                daemon, simulated = summary(run), build.simulate(run.name)
                table.append(row(run.name, daemon, simulated))
                self.check_loop(daemon)
                self.check_motion(run.name, daemon, simulated)
                self.assertIn("equal to the bit", build.call("replay", run / "run.ulg"))
        print("\n".join([row_of_names(), *table]))

    def check_loop(self, daemon):
        loop = daemon["loop"]
        self.assertEqual(daemon["outcome"], "completed")
        self.assertGreaterEqual(daemon["cycles"], CYCLES)
        self.assertLessEqual(daemon["cycles"], CYCLES + STOPPING_CYCLES)
        self.assertEqual(loop["missed_cycles"], 0)
        self.assertEqual(loop["dropped_records"], 0)
        self.assertEqual(loop["page_faults"], 0)
        self.assertEqual(loop["malformed_drive_frames"], 0)
        for counter in ["malformed", "repeated"]:
            self.assertEqual(loop["tactile"][counter], 0, counter)
        self.assertLessEqual(loop["tactile"]["incomplete"], 1)  # the module spoke as the daemon came
        for bus in loop["buses"]:
            for counter in ["refused", "held_back", "error_frames", "foreign"]:
                self.assertEqual(bus[counter], 0, f"{bus['interface']}: {counter}")

    def check_motion(self, name, daemon, simulated):
        peak = DEVIATION_ESTIMATED_PEAK if "_estimated" in name else DEVIATION
        for force, limit in {"peak_force_N": peak, "final_force_N": DEVIATION}.items():
            self.assertAlmostEqual(daemon[force] / simulated[force], 1.0, delta=limit, msg=force)
        self.assertEqual(len(daemon["contacts"]), len(simulated["contacts"]))


def row_of_names():
    return f"{'scene':24}{'cycles':>8}{'missed':>8}{'peak N':>18}{'final N':>18}"


def row(name, daemon, simulated):
    def pair(key):
        return f"{daemon[key]:9.3f} /{simulated[key]:7.3f}"

    return (f"{name:24}{daemon['cycles']:8}{daemon['loop']['missed_cycles']:8}"
            f"{pair('peak_force_N')}{pair('final_force_N')}  daemon / simulate")  # fmt: skip


if __name__ == "__main__":
    every = "--all" in sys.argv
    sys.argv = [word for word in sys.argv if word != "--all"]
    build = Build()
    results = build.run("all_scenes", timeout_s=5 * TIMEOUT_S) if every else build.run("scenes")
    unittest.main(argv=sys.argv[:1])
