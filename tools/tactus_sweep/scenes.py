"""The scenes of a study: loaded once, and tried with what the study sets."""

import pathlib

import tactus
from tactus import _core
from tactus._sweep import as_bytes, load

from .study_text import StudyError, one_line


def load_files(study):
    """Of each scene its files as they are now, [(path, text)]. Raises StudyError."""
    return [read_files(item, path) for item, _, path in study.scenes]


def read_files(item, path):
    try:
        return _core.load_scene(as_bytes(str(pathlib.Path(path).absolute())), []).sources()
    except tactus.ConfigError as error:
        if error.line == 1 and error.key == "-" and not pathlib.Path(path).is_file():
            raise item.error(f"'{item.node.value}' is no file", "a scene, relative to this file") from error
        raise StudyError(one_line(str(error))) from error


def check_keys(study, plan):
    """Each key, with the ends of what it takes, in each scene. Whether values fit together the runs find
    out: a run that a scene refuses is one of its rows."""
    places = {setting.split("=")[0]: entry for entry, setting in study.fixed}
    places |= {axis.key: axis.entry for axis in study.axes}
    for files, (_, name, _) in zip(plan.scenes, study.scenes):
        for entry, setting in study.fixed:
            try_setting(files, plan.fixed, setting, places, name)
        first = plan.settings(0)
        for axis in study.axes:
            for setting in axis.ends():
                try_setting(files, first, setting, places, name)


def try_setting(files, settings, setting, places, scene):
    """In the order of a run: of several wrong keys one is the first that is seen, and it is tried, too."""
    key = setting.split("=")[0]
    try:
        load(files, [setting if other.split("=")[0] == key else other for other in settings])
    except tactus.ConfigError as error:
        mark = f"--set {key}"
        if error.file != mark:
            return
        problem = str(error).removeprefix(f"{mark}:{error.line}:{error.column}: ")
        at = places[key].name_mark
        raise StudyError(one_line(f"{places[key].path}:{at.line + 1}:{at.column + 1}: {problem}, "
                                  f"in {scene}")) from error
