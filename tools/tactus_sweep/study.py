"""A study: which scenes run with which values, and how the runs are judged."""

import dataclasses
import itertools
import pathlib
import re

from tactus._sweep import ALL_FIGURES, Plan

from .axes import read_grid, read_random
from .study_text import StudyError, read_node

SECTIONS = ("scenes", "set", "grid", "latin_hypercube", "sobol", "disturbances", "limits", "objective")
MAX_RUNS = 1_000_000
MAX_SEED = 2**31 - 1


@dataclasses.dataclass
class Points:
    """Settings that are drawn together: one list of settings a point."""

    axes: list
    count: int = 1
    seed: int = 0
    kind: str = ""


@dataclasses.dataclass
class Study:
    path: pathlib.Path
    root: object  # Node of the file
    scenes: list  # (Node, path as the study names it, path from here)
    fixed: list  # (Node, KEY=VALUE)
    grid: list  # axes
    points: Points
    disturbances: Points
    limits: dict  # {figure: largest value}
    objective: dict  # {figure: weight}

    @property
    def axes(self):
        return self.grid + self.points.axes + self.disturbances.axes


def read_study(path):
    """Raises StudyError."""
    root = read_node(path)
    entries = root.section(SECTIONS)
    if "scenes" not in entries:
        raise root.error("without scenes", "a list of scenes, relative to this file")
    if "latin_hypercube" in entries and "sobol" in entries:
        raise entries["sobol"].error("beside latin_hypercube", "one of them")
    kind = "sobol" if "sobol" in entries else "latin_hypercube"
    study = Study(pathlib.Path(path), root, read_scenes(entries["scenes"], pathlib.Path(path).parent),
                  read_fixed(entries.get("set")), read_axes(entries.get("grid"), read_grid),
                  read_points(entries.get(kind), kind, "points"),
                  read_points(entries.get("disturbances"), "random", "draws"),
                  read_figures(entries.get("limits")), read_objective(entries.get("objective")))
    refuse_twice(study)
    refuse_files(study)
    return study


def keys_of(section):
    """Each with its key as of --set, which has dots of its own."""
    entries = section.entries()
    for name, entry in entries.items():
        if not name or "=" in name or name != name.strip():
            raise entry.error("no key", "such as controller.damping")
        entry.key_set = name
    return entries


def read_scenes(section, folder):
    scenes = []
    for item in section.items("a list of scenes"):
        name = item.word("path of a scene, relative to this file")
        if any(name == other for _, other, _ in scenes):
            raise item.error(f"'{name}' is there twice", "each scene once")
        scenes.append((item, name, folder / name))
    if not scenes:
        raise section.error("an empty list", "at least one scene")
    return scenes


def read_fixed(section):
    if section is None:
        return []
    return [(entry, f"{name}={entry.setting()}") for name, entry in keys_of(section).items()]


def read_axes(section, read):
    if section is None:
        return []
    axes = [read(entry) for entry in keys_of(section).values()]
    if not axes:
        raise section.error("without a key", "at least one")
    return axes


def read_points(section, kind, count):
    if section is None:
        return Points([])
    entries = section.section((count, "seed", "keys"))
    for name in (count, "keys"):
        if name not in entries:
            raise section.error(f"without {name}", f"{count}, keys")
    points = Points(read_axes(entries["keys"], read_random), entries[count].whole(1, MAX_RUNS),
                    entries["seed"].whole(0, MAX_SEED) if "seed" in entries else 1, kind)
    if kind == "sobol" and points.count & (points.count - 1):
        raise entries[count].wrong("a power of 2, with which Sobol points fill the space evenly")
    return points


def read_figures(section):
    if section is None:
        return {}
    return {name: entry.number() for name, entry in section.section(ALL_FIGURES).items()}


def read_objective(section):
    """Sum of figures by their weights, as small as can be."""
    if section is None:
        return {"peak_force_N": 1.0}
    if not section.is_section:
        name = section.word(f"one of {', '.join(ALL_FIGURES)}, or weights of several")
        if name not in ALL_FIGURES:
            raise section.wrong(f"one of {', '.join(ALL_FIGURES)}, or weights of several")
        return {name: 1.0}
    weights = read_figures(section)
    if not any(weights.values()):
        raise section.error("without a weight", "at least one that is not 0")
    return weights


def refuse_twice(study):
    """Also keys that are spelled in two ways, and a section that comes after one of its keys: it would take the
    place of what is before."""
    entries = [*((entry.key_set, entry) for entry, _ in study.fixed), *((axis.key, axis.entry) for axis in study.axes)]
    sections = []  # that the next key is in
    for words, place in sorted((words_of(key), place) for place, (key, _) in enumerate(entries)):
        sections = [section for section in sections if words[:len(section[0])] == section[0]]
        for section, section_place in sections:
            if words == section:
                entry = entries[max(place, section_place)][1]
                raise entry.error("has its values elsewhere in the study, too", "each key once")
            if place < section_place:
                raise entries[section_place][1].error(f"takes the place of {entries[place][0]}, which is before",
                                                      "one of them")
        sections.append((words, place))


def refuse_files(study):
    """A study has one state of the files of each scene."""
    for axis in study.axes:
        if names_file(axis.key):
            raise axis.entry.error("a file cannot vary within a study", "a scene for each in scenes")


def names_file(key):
    return re.fullmatch(r"robot(\.(.*\.)?(urdf|profile))?", key) is not None


def words_of(key):
    """"a.b[02].c" is a, b, 2], c."""
    return [re.sub(r"^0+(?=[0-9]+\]$)", "", word) for word in re.split(r"[.\[]", key)]


def draw(points):
    """The settings of each point."""
    if not points.axes:
        return [[]]
    from scipy.stats import qmc

    engine = {"sobol": lambda count, seed: qmc.Sobol(count, seed=seed),
              "latin_hypercube": lambda count, seed: qmc.LatinHypercube(count, seed=seed),
              "random": RandomPoints}[points.kind](len(points.axes), points.seed)
    return [[axis.at(float(u)) for axis, u in zip(points.axes, point)]
            for point in engine.random(points.count)]


class RandomPoints:
    def __init__(self, dimensions, seed):
        import numpy as np

        self.dimensions, self.generator = dimensions, np.random.Generator(np.random.PCG64(seed))

    def random(self, count):
        return self.generator.random((count, self.dimensions))


def make_plan(study, files):
    """`files` of each scene. Raises StudyError where there are too many runs."""
    count = len(files) * study.points.count * study.disturbances.count
    for axis in study.grid:
        count *= len(axis.texts)
    if count > MAX_RUNS:
        raise study.root.error(f"{count} runs", f"at most {MAX_RUNS}")
    grid = [list(settings) for settings in itertools.product(
        *([f"{axis.key}={text}" for text in axis.texts] for axis in study.grid))]
    return Plan(files, [setting for _, setting in study.fixed],
                [grid, draw(study.points), draw(study.disturbances)])


