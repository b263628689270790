"""What the runs say: which are good, which values matter."""

import dataclasses
import math

import numpy as np
from tactus._sweep import OF_CONTACTS

from .table import scene_name

FORCE, ERROR = "peak_force_N", "tcp_error_max_m"
PATH_LEFT, UNSENSED = "path_left_s", "unsensed_force_N"
# What may be bad of a run whose force and error are good.
HIDDEN = {PATH_LEFT: "did not come to the end of their path, up to {:.3g} s of it are left",
          "module_losses": "lost a module, up to {:g} times",
          UNSENSED: "push up to {:.4g} N where no module is"}
SHOWN = 10  # of the best, and of the worst
BINS = 16
LEAST_RUNS = 8  # for a sensitivity that says something


@dataclasses.dataclass
class Candidate:
    """What the study can choose: a place of the grid with a point. Its figures are the worst of its runs, over
    scenes and disturbances."""

    place: tuple
    runs: list
    objective: float
    force_N: float
    error_m: float
    is_fit: bool  # all runs completed, within the limits

    @property
    def worst(self):
        return max(self.runs, key=lambda row: row["objective"])

    @property
    def path_left_s(self):
        return largest(self.runs, PATH_LEFT)

    @property
    def unsensed_N(self):
        return largest(self.runs, UNSENSED)


def completed(row):
    return row["outcome"] == "completed"


def judge(study, rows):
    """Adds objective and is_within to each row: of a run that was not completed inf and False."""
    for row in rows:
        values = [figure(row, name) for name in study.objective]
        is_known = completed(row) and None not in values
        row["objective"] = (sum(weight * value for weight, value in zip(study.objective.values(), values))
                            if is_known else math.inf)
        row["is_within"] = completed(row) and all(
            is_kept(row, name, limit) for name, limit in study.limits.items())


def figure(row, name):
    """None where nobody knows it. What contacts have at most is 0 where there were none."""
    if row.get(name) is None and name in OF_CONTACTS and row.get("contacts") == 0:
        return 0.0
    return row.get(name)


def is_kept(row, name, limit):
    """What nobody knows keeps no limit."""
    value = figure(row, name)
    return value is not None and value <= limit


def has_choice(plan):
    return len(plan.parts[0]) * len(plan.parts[1]) > 1


def candidate_text(study, plan, row):
    """What tells a candidate from others, of one of its runs: not the disturbances that it meets."""
    axes = study.grid + study.points.axes if has_choice(plan) else study.axes
    chosen = {axis.key for axis in axes}
    words = [setting for setting in plan.settings(row["run"]) if setting.split("=")[0] in chosen]
    if not has_choice(plan) and (len(plan.scenes) > 1 or not words):
        words.insert(0, scene_name(study, plan, row))
    return ", ".join(words)


def candidates(plan, rows):
    """The best first. Where there is nothing to choose, each run is one."""
    groups = {}
    for row in rows:
        place = plan.place(row["run"])
        groups.setdefault(place[1:3] if has_choice(plan) else place, []).append(row)
    found = [candidate_of(place, runs) for place, runs in groups.items()]
    return sorted(found, key=lambda one: (not one.is_fit, one.objective, one.place))


def candidate_of(place, runs):
    return Candidate(place, runs, max(row["objective"] for row in runs), largest(runs, FORCE), largest(runs, ERROR),
                     all(row["is_within"] for row in runs))


def largest(runs, name):
    """inf where one of them is unknown."""
    return max((math.inf if not completed(row) or row.get(name) is None else row[name]) for row in runs)


def notes(study, rows):
    """What the study has no limit for, of the runs that keep those that it has."""
    found = []
    for name, text in HIDDEN.items():
        values = [row[name] for row in rows if row["is_within"] and row.get(name)]
        if values and name not in study.limits:
            found.append(f"{len(values)} runs within the limits {text.format(max(values))}: limit {name}")
    return found


def front(found):
    """Those that no other one beats in both, by rising force."""
    best, lowest = [], math.inf
    for one in sorted(found, key=lambda one: (one.force_N, one.error_m, one.place)):
        if math.isfinite(one.force_N) and one.error_m < lowest:
            best.append(one)
            lowest = one.error_m
    return best


def ranks(values):
    """From 1, equal ones share the mean."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(counts) - (counts - 1) / 2)[inverse]


def rank_correlation(x, y):
    """Spearman's, NaN where one does not vary."""
    x, y = ranks(x), ranks(y)
    deviation = np.std(x) * np.std(y)
    return float(np.mean((x - x.mean()) * (y - y.mean())) / deviation) if deviation > 0 else math.nan


def variance_share(x, y):
    """Of the variance of y what x alone explains, by the means of bins of x; corrected for what as many bins
    would explain by chance (Kelley's epsilon squared)."""
    groups = bins_of(x)
    count, bins = len(y), groups.max() + 1
    total = np.sum((y - y.mean()) ** 2)
    if bins < 2 or count <= bins or total <= 0:
        return math.nan
    means = np.bincount(groups, y) / np.bincount(groups)
    rest = np.sum((y - means[groups]) ** 2)
    return float(max(0.0, 1.0 - rest / (count - bins) * (count - 1) / total))


def bins_of(x):
    """Its values, or slices with as many runs each where there are many values."""
    values, inverse = np.unique(x, return_inverse=True)
    bins = min(BINS, max(2, len(x) // 8))
    if len(values) <= bins:
        return inverse
    places = np.minimum((ranks(x) - 1) * bins // len(x), bins - 1).astype(int)
    return np.unique(places, return_inverse=True)[1]


@dataclasses.dataclass
class Sensitivity:
    key: str
    correlation: dict  # {figure: Spearman's, NaN of names}
    share: dict  # {figure: first-order share of the variance}


def sensitivities(study, plan, rows):
    """Of the completed runs of one scene, the strongest first."""
    rows = [row for row in rows if completed(row)]
    if len(rows) < LEAST_RUNS:
        return []
    settings = [dict(setting.split("=", 1) for setting in plan.settings(row["run"])) for row in rows]
    found = [sensitivity(axis.key, [setting[axis.key] for setting in settings], rows) for axis in study.axes]
    return sorted(found, key=lambda one: -max((share for share in one.share.values()
                                               if not math.isnan(share)), default=0.0))


def sensitivity(key, texts, rows):
    try:
        x, is_number = np.array([float(text) for text in texts]), True
    except ValueError:
        x, is_number = np.unique(texts, return_inverse=True)[1], False
    figures = {name: np.array([row[name] for row in rows], float) for name in (FORCE, ERROR)}
    return Sensitivity(key, {name: rank_correlation(x, y) if is_number else math.nan
                             for name, y in figures.items()},
                       {name: variance_share(x, y) for name, y in figures.items()})
