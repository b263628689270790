"""`tactus save`, while the first call of a function by a way fails."""
import os
import pathlib
import re
import subprocess
import tempfile

from failing import LIBRARY, MOST, NOT_AGAIN, PATIENCE_S, TACTUS, known_outcome, place_of, spread, tried
from running import COMMANDS, ask, virtual_daemon


class Saves:
    """`tactus save` of a gain of a daemon that runs, again and again."""
    BEFORE = f"extends: {COMMANDS}\ncontroller:\n  damping: 1  # of the engineer\n"

    def __init__(self, folder, path):
        self.folder, self.path, self.scene = folder, path, pathlib.Path(folder, "scene.yaml")
        self.after = ""

    def run(self, **failure):
        self.scene.write_text(self.BEFORE)
        for request in [{"do": "reload"}, {"do": "set", "values": {"controller.damping": 0.7}}]:
            assert ask(self.path, request)["done"]
        pathlib.Path(self.folder, "place").unlink(missing_ok=True)
        environment = {**os.environ, "LD_PRELOAD": LIBRARY, "RUNTIME_DIRECTORY": self.folder,
                       "FAIL_PLACE": f"{self.folder}/place", **failure}
        return subprocess.run([TACTUS, "save"], env=environment, capture_output=True, text=True,
                              timeout=PATIENCE_S, check=False)

    def outcome_of(self, call, way):
        """The scene's file is as it was, or as it is to be, whatever fails."""
        done = self.run(FAIL_CALL=call, FAIL_WAY=way)
        place, text = place_of(self.folder, TACTUS), self.scene.read_text()
        left = [path for path in pathlib.Path(self.folder).glob("scene.yaml.??????")]
        for path in left:
            path.unlink()
        known = known_outcome(done.returncode, done.stderr, place)
        outcome = known or f"ends with a line and {done.returncode}" if done.returncode else "as without"
        trouble = None
        if text not in (self.BEFORE, self.after) or done.returncode == 0 and text != self.after:
            trouble = f"leaves {text} in {place}"
        elif done.returncode < 0 and not known or done.returncode > 0 and not done.stderr:
            trouble = f"ends ({done.returncode}) in {place}: {done.stderr}"
        elif left and not known and call != "unlink":
            trouble = f"leaves {left} in {place}: {done.stderr}"
        elif text == self.after and done.returncode > 0 and call != "malloc" and \
                not re.search("is written|standard output", done.stderr):
            trouble = f"saves, and does not say so: {done.stderr}"
        elif not place:
            outcome = NOT_AGAIN
        if done.returncode > 0:
            outcome += ", saved" if text == self.after else ", not saved"
        return outcome, trouble


def save_outcomes(most=MOST):
    """As running_outcomes(), of a save."""
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "scene.yaml").write_text(Saves.BEFORE)
        with virtual_daemon(folder, "scene.yaml", subprocess.DEVNULL) as (_, path):  # who reads no pipe fills it
            saves = Saves(folder, path)
            done = saves.run(FAIL_WAYS=f"{folder}/ways")
            saves.after = saves.scene.read_text()
            assert done.returncode == 0 and "damping: 0.7  # of" in saves.after, done.stderr
            found = {}
            for line in pathlib.Path(folder, "ways").read_text().splitlines():
                call, way, count = line.split()
                found.setdefault(call, []).append((way, int(count)))
            for call, those in sorted(found.items(), key=lambda one: len(one[1])):
                for way, _ in spread(those, most):
                    for outcome in tried(f"save {call} {way.split(':')[0]}", lambda: saves.outcome_of(call, way)):
                        yield call, sum(count for _, count in those), len(those), way, *outcome
