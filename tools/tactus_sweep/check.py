"""What `tactus check`, and so tactusd, would say of what a study can choose."""

import concurrent.futures
import dataclasses
import json
import os

import tactus
from tactus._sweep import load

from .table import scene_name


@dataclasses.dataclass
class Check:
    margin_deg: float | None = None  # the least phase margin of its loops, in any scene
    refusal: str = ""  # of the first scene that refuses it

    @property
    def text(self):
        if self.refusal:
            return f"refused: {self.refusal}"
        return "" if self.margin_deg is None else f"phase margin {self.margin_deg:.1f}°"


def check_candidates(study, plan, found):
    """A Check of each, in each scene of its runs. Without the disturbances: they are not of the arm."""
    jobs = [(one, row) for one in found for row in first_rows(plan, one)]
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as threads:
        said = list(threads.map(lambda job: check_run(study, plan, job[1]), jobs))
    return [together([check for (of, _), check in zip(jobs, said) if of is one]) for one in found]


def first_rows(plan, one):
    """One of each scene."""
    rows = {}
    for row in one.runs:
        rows.setdefault(plan.place(row["run"])[0], row)
    return rows.values()


def check_run(study, plan, row):
    _, grid, point, _ = plan.place(row["run"])
    settings = plan.fixed + plan.parts[0][grid] + plan.parts[1][point]
    try:
        scene = load(plan.files(row["run"]), settings)
    except tactus.ConfigError:
        return Check()  # the disturbances are what makes it whole
    try:
        loops = json.loads(scene.check()).get("stability", {}).get("loops", [])
    except tactus.ConfigError as error:
        return Check(refusal=refusal_of(error, study, plan, row))
    return Check(least([loop["phase_margin_deg"] for loop in loops]))


def refusal_of(error, study, plan, row):
    text = str(error).removeprefix(f"{error.file}:{error.line}:{error.column}: ")
    return text if len(plan.scenes) == 1 else f"{text}, in {scene_name(study, plan, row)}"


def least(margins):
    """None of none; of a loop that has no phase margin it is None, too."""
    return min((margin for margin in margins if margin is not None), default=None)


def together(checks):
    refusals = [check.refusal for check in checks if check.refusal]
    return Check(least([check.margin_deg for check in checks]), refusals[0] if refusals else "")
