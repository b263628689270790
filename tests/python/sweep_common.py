"""What the tests of `tactus sweep` share."""

import csv
import json
import re
import subprocess
import sys

from common import ROOT, SCENES, TACTUS, Scratch

sys.path.insert(0, str(ROOT / "tools"))

SCENE = SCENES / "robots/planar2_contact.yaml"
# Some runs are refused, as an obstacle may not vanish before it appears, some end with a fault.
STUDY = f"""
scenes: [{SCENE}, {SCENES / "robots/ur5e_contact.yaml"}]
set: {{simulation.duration_s: 5}}
grid:
  simulation.obstacles[0].appears_s: [0, 4]
  simulation.obstacles[0].vanishes_s: [3.6, 4.9]
latin_hypercube:
  points: 5
  keys:
    controller.damping: {{from: 0.5, to: 1}}
    controller.time_constant_s: {{from: 0.05, to: 0.2, scale: log}}
disturbances:
  draws: 3
  keys:
    simulation.tactile_module.seed: {{from: 1, to: 1000, whole: true}}
    simulation.tactile_module.noise_N: {{mean: 0.03, standard_deviation: 0.02, from: 0, to: 0.1}}
    robot.tactile_modules[0].max_force_N: [1.3, 100]
limits: {{peak_force_N: 1.38}}
"""
RUNS = 2 * 4 * 5 * 3


class Sweeps(Scratch):
    def study(self, text=STUDY):
        return self.file("study.yaml", text)

    def command(self, study, folder, *arguments):
        return [TACTUS, "sweep", study, "-o", folder, *map(str, arguments)]

    def sweep(self, study, folder, *arguments, **options):
        done = subprocess.run(self.command(study, folder, *arguments), text=True, capture_output=True,
                              timeout=300, **options)
        done.stderr = without_progress(done.stderr)
        return done

    def whole(self, name="whole", *arguments, study=None):
        """A study that ran without interruption: its folder."""
        done = self.sweep(study or self.study(), self.folder / name, *arguments)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return self.folder / name


def without_progress(text):
    """On a slow machine a sweep tells how far it is."""
    return re.sub(r"^\d+ of \d+ runs, .*\n", "", text, flags=re.M)


def table_of(folder):
    return (folder / "table.csv").read_bytes()


def rows_of(folder):
    with open(folder / "table.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def runs_in(folder):
    """Numbers of the runs in the results, as they stand there."""
    lines = (folder / "results.jsonl").read_bytes().split(b"\n")
    assert lines.pop() == b""
    return [json.loads(line[9:])["run"] for line in lines[1:]]
