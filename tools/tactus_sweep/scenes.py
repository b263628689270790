"""The scenes of a study: loaded once, and tried with what the study sets."""

import pathlib

import tactus
from tactus import _core
from tactus._sweep import as_bytes, load

from .study import names_file
from .study_text import StudyError, one_line

MAX_WORDS = 8  # of a list, each tried with the values of the other keys


def load_files(study):
    """Of each scene its files as they are now, [(path, text)]. Raises StudyError."""
    return [read_files(item, path, study.fixed) for item, _, path in study.scenes]


def read_files(item, path, fixed):
    """With what the study sets, which may be what the scene lacks; or else with the files that it sets alone, for
    the rest may be right with other keys, and check_keys() finds what is wrong."""
    file = as_bytes(str(pathlib.Path(path).absolute()))
    entries = {setting.split("=")[0]: (entry, as_bytes(setting)) for entry, setting in fixed}
    problem = None
    for keys in (entries, filter(names_file, entries)):
        try:
            return _core.load_scene(file, [entries[key][1] for key in keys]).sources()
        except tactus.ConfigError as error:
            problem = problem or error
    key = str(problem.file).removeprefix("--set ")
    if problem.line == 1 and problem.key == "-" and not pathlib.Path(path).is_file():
        raise item.error(f"'{item.node.value}' is no file", "a scene, relative to this file") from problem
    raise (error_of_key(problem, entries[key][0], item.node.value) if key in entries
           else StudyError(one_line(str(problem)))) from problem


def error_of_key(error, entry, scene):
    """Of --set, where the study has the key."""
    problem = str(error).removeprefix(f"{error.file}:{error.line}:{error.column}: ")
    at = entry.name_mark
    return StudyError(one_line(f"{entry.path}:{at.line + 1}:{at.column + 1}: {problem}, in {scene}"))


def check_keys(study, plan):
    """Each key, with the ends of what it takes, in each scene. Whether values fit together the runs find
    out: a run that a scene refuses is one of its rows."""
    places = {setting.split("=")[0]: entry for entry, setting in study.fixed}
    places |= {axis.key: axis.entry for axis in study.axes}
    tried = [(setting, [plan.fixed, *choices(study, plan, None)]) for _, setting in study.fixed]
    for axis in study.axes:
        others = choices(study, plan, axis)  # of all settings of the axis
        tried += [(setting, others) for setting in axis.ends()]
    for files, (_, name, _) in zip(plan.scenes, study.scenes):
        for setting, others in tried:
            try_setting(files, others, setting, places, name)


def choices(study, plan, axis):
    """What a setting of the axis is tried with: the first run's settings, then the other axes at their ends, all
    and one by one. A value that only some of these refuse is not impossible."""
    ends = [outermost(other) for other in study.axes if other is not axis]
    first = plan.settings(0)
    bases = [first, replaced(first, [few[0] for few in ends]), replaced(first, [few[-1] for few in ends])]
    found = bases + [replaced(base, [one]) for base in bases for few in ends for one in few]
    return list(map(list, dict.fromkeys(map(tuple, found))))


def outermost(axis):
    ends = axis.ends()
    try:
        ends.sort(key=lambda setting: float(setting.split("=", 1)[1]))
    except ValueError:  # words, of which any may be the one that others fit
        return ends[:MAX_WORDS]
    return [ends[0], ends[-1]]


def replaced(settings, new):
    values = {setting.split("=")[0]: setting for setting in new}
    return [values.get(setting.split("=")[0], setting) for setting in settings]


def try_setting(files, others, setting, places, scene):
    """Refuses it if none of the others takes it, and it is to blame. Each stands in the order of a run: of several
    wrong keys one is the first that is seen, and it is tried, too."""
    problem = None
    for number, settings in enumerate(others):
        try:
            load(files, replaced(settings, [setting]))
        except tactus.ConfigError as error:
            key = setting.split("=")[0]
            if error.file == f"--set {key}":
                problem = problem or error
            continue
        if number > 1:
            others.insert(1, others.pop(number))  # likely to do for the next value, too
        return
    if problem is not None:
        raise error_of_key(problem, places[key], scene)
