"""Runs a guest script with the daemon in it, for the checks of its results."""

import argparse
import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
TIMEOUT_S = 1200  # a machine that is busy with other things takes ten times as long
SCENES = REPOSITORY / "config" / "scenes"


class Build:
    """Where the programs are and where results go, from the command line."""

    def __init__(self):
        parser = argparse.ArgumentParser()
        parser.add_argument("--tactus", type=Path, required=True)
        parser.add_argument("--tactusd", type=Path, required=True)
        parser.add_argument("--out", type=Path, required=True, help="made anew by each run")
        parser.add_argument("--program", type=Path, action="append", default=[])
        parser.add_argument("--folder", action="append", default=[], metavar="PATH=SOURCE")
        parser.add_argument("--keep", action="store_true", help="judge the results of the last run")
        options = parser.parse_args()
        self.tactus = options.tactus
        self.programs = [options.tactus, options.tactusd, *options.program]
        self.folders = options.folder
        self.out = options.out
        self.keep = options.keep

    def run(self, test, folder=None, timeout_s=TIMEOUT_S):
        """Returns the folder with what the guest left in /out. Ends the program if it fails."""
        out = self.out / (folder or test)
        if not self.keep:
            command = [sys.executable, HERE / "run.py", test, "--out", out, "--timeout", str(timeout_s)]
            for program in self.programs:
                command += ["--program", program]
            for path in ["config", "tests/hil/scenes"]:  # the same place as in the repository
                command += ["--folder", f"{path}={REPOSITORY / path}"]
            for folder in self.folders:
                command += ["--folder", folder]
            status = subprocess.run(command, check=False).returncode
            if status != 0:
                sys.exit(f"{test}: the guest's script ended with status {status}; see {out}")
        return out

    def call(self, *arguments):
        """What `tactus ARGUMENTS` prints."""
        done = subprocess.run([self.tactus, *arguments], capture_output=True, text=True, check=True)
        return done.stdout

    def simulate(self, name):
        """The summary of `tactus simulate`, on this machine."""
        folder = self.out / "simulated"
        self.call("simulate", SCENES / f"{name}.yaml", "-o", folder)
        return summary(folder / Path(name).name)


def summary(folder):
    return json.loads((folder / "summary.json").read_text())
