"""A log must replay to the bit on a processor without FMA and AVX, where libm takes other paths."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCENES = Path(__file__).resolve().parents[2] / "config" / "scenes"
OLD_PROCESSOR = {**os.environ, "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2"}
TURNING_TOOL = [
    "--set", "task.components=[x, y, z, rx, ry, rz]",
    "--set", "task.trajectory.line={displacement_m: [0, 0.2, 0], rotation_vector_rad: "
             "[0.3, -0.2, 0.4], speed_m_per_s: 0.0537, ramp_s: 0.5}",
    "--set", "simulation.duration_s=5",
]  # fmt: skip


class ReplayElsewhere(unittest.TestCase):
    def replays(self, scene, *options):
        with tempfile.TemporaryDirectory() as folder:
            command = [TACTUS, "simulate", SCENES / f"{scene}.yaml", "-o", folder, *options]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            log = Path(folder) / scene / "run.ulg"
            done = subprocess.run([TACTUS, "replay", log], env=OLD_PROCESSOR, text=True,
                                  capture_output=True, check=False)  # fmt: skip
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_orientation(self):
        self.replays("free_motion", *TURNING_TOOL)

    def test_estimation(self):
        self.replays("scenario2_estimated")

    def test_joint_space(self):
        self.replays("scenario1_joint_space")


if __name__ == "__main__":
    TACTUS = sys.argv.pop(1)
    unittest.main()
