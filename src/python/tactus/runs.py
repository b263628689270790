"""Runs and their logs."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._settings import Path, path_bytes, settings
from .errors import ConfigError
from .scene import Scene

if TYPE_CHECKING:
    import pandas

FAULTS: tuple[str, ...] = _core.FAULTS  #: by the number in the field `fault`
MODES: tuple[str, ...] = _core.MODES  #: by the number in the field `mode`
_HEAD_BYTES = 1 << 20  # has what a log tells of its run, and its first cycles


class Log(Mapping[str, NDArray[Any]]):
    """All cycles of a run: a mapping of the log's fields to arrays, as docs/log.md lists them.

    A field has the shape (cycles,); q, dq and q_measured (cycles, joints); w, wd and wd_dot (cycles,
    task components); what is of each tactile module (cycles, modules) where there are several, else
    (cycles,). Numbers are float64, counts int64 or uint64. Arrays show the log's own memory: they are
    not copied, cannot be written, and keep it alive.
    """

    def __init__(self, columns: _core.Columns) -> None:
        if not isinstance(columns, _core.Columns):
            raise TypeError("made by simulate() and read_log() alone")
        self._columns = columns
        self._units = columns.units()

    def __getitem__(self, field: str) -> NDArray[Any]:
        if field not in self._units:
            raise KeyError(f"{field!r}, expected one of {', '.join(self._units)}")
        return self._columns.array(field)

    def __iter__(self) -> Iterator[str]:
        return iter(self._units)

    def __len__(self) -> int:
        return len(self._units)

    # Equal to itself alone: arrays have no single answer.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    @property
    def cycles(self) -> int:
        """How many."""
        return self._columns.cycles

    @property
    def units(self) -> dict[str, str]:
        """Of each field; "" for numbers without one."""
        return dict(self._units)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Each column of the CSV of `tactus export`, (cycles,): q_1, q_2 and so on."""
        arrays = {}
        for name, field, entry in self._columns.places():
            array = self._columns.array(field)
            arrays[name] = array if array.ndim == 1 else array[:, entry]
        return arrays

    def to_pandas(self) -> pandas.DataFrame:
        """The columns of the CSV, names of fault and mode included, by t_s. Needs pandas."""
        import pandas

        columns: dict[str, Any] = self.columns()
        for name, names in (("fault", FAULTS), ("mode", MODES)):
            codes = np.minimum(columns[name], len(names)).astype(np.int64)
            columns[name + "_name"] = pandas.Categorical.from_codes(codes, [*names, "unknown"])
        return pandas.DataFrame(columns).set_index("t_s")


class Run(Log):
    """What simulate() returns: the log, and the figures of the run."""

    def __init__(self, columns: _core.Columns, scene: Scene, summary: dict[str, Any]) -> None:
        super().__init__(columns)
        self.scene = scene
        self.summary = summary  #: what summary.json of `tactus simulate` holds

    @property
    def contacts(self) -> list[dict[str, Any]]:
        """Figures of each contact, in the order of their start, as in summary.json."""
        return self.summary["contacts"]  # type: ignore[no-any-return]

    @property
    def fault(self) -> str | None:
        """The fault that ended the run; None: it was completed."""
        number = int(self["fault"][-1]) if self.cycles else 0
        return FAULTS[number] if number else None

    def __repr__(self) -> str:
        return f"<tactus.Run of {self.scene.name!r}, {self.cycles} cycles, {self.fault or 'completed'}>"


class LogFile(Log):
    """What read_log() returns."""

    def __init__(self, path: Path) -> None:
        self._file = os.path.abspath(path_bytes(path))  # the folder may be another one later
        self._head = _head_of(self._file, _HEAD_BYTES)
        (columns, self.is_cut_off, self.part, self.infos, self.parameters, self.sources,
         self.overrides) = _core.read_log(path_bytes(path))
        super().__init__(columns)
        self.path = path

    is_cut_off: bool  #: it ends within a cycle: the run was interrupted
    part: int  #: of its run, from 0; above that the run did not begin with this log
    infos: dict[str, str]  #: what the log says of the run
    parameters: dict[str, float]  #: numbers of scene and robot, as plots show them: rounded to float32
    sources: dict[str, str]  #: the text of each file that the run was made of, the scene first, by its path
    overrides: dict[str, str]  #: values given by `--set`, by key

    @property
    def joints(self) -> list[str]:
        """Names, from the base to the tool."""
        return self._named("joint")

    @property
    def modules(self) -> list[str]:
        """The link of each tactile module, in the order of the fields' columns."""
        return self._named("tactile_module")

    def _named(self, what: str) -> list[str]:
        return [name for key, name in self.infos.items() if key.startswith(what + "/")]

    @functools.cached_property
    def contacts(self) -> list[dict[str, Any]]:
        """Figures of each contact, in the order of their start: `tactus contacts --json`.

        Read from the file when they are first asked for; ConfigError if another run has taken its place
        since then. UserWarning if the log does not begin with its run: a contact at its begin may be
        older, and counts from there on only."""
        contacts: list[dict[str, Any]] = json.loads(_core.contacts(self._file))
        if _head_of(self._file, self._head[0]) != self._head:  # behind it, so that none slips in between
            raise _other_file(os.fsdecode(self.path))
        if self.part > 0:
            warnings.warn(f"{os.fsdecode(self.path)}: begins at {self['t_s'][0]:.3f} s of the run: what was "
                          "before is not in it, nor counts for a contact of then", stacklevel=3)
        return contacts

    def __repr__(self) -> str:
        return f"<tactus.LogFile {str(self.path)!r}, {self.cycles} cycles>"


def _head_of(file: bytes, most: int) -> tuple[int, bytes]:
    """How many bytes there are at its begin, at most these, and their hash: a log that grows keeps them."""
    head = b""
    # Of a pipe they would be lost, and what cannot be read the reader of logs says better.
    with contextlib.suppress(OSError):
        if os.path.isfile(file):
            with open(file, "rb") as log:
                head = log.read(most)
    return len(head), hashlib.sha256(head).digest()


def _other_file(path: str) -> ConfigError:
    return ConfigError(f"{path}:1:1: -: another file than was read, expected the same log", path, 1, 1, "-")


def simulate(scene: Scene) -> Run:
    """Runs a scene in virtual time, as `tactus simulate` does, but writes no file.

    Other threads go on meanwhile, and may simulate, too. Ctrl-C ends it.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"a {type(scene).__name__}, expected a tactus.Scene")
    columns, summary = _core.simulate(scene._core)
    return Run(columns, scene, json.loads(summary))


def read_log(path: Path) -> LogFile:
    """Reads a log, run.ulg. ConfigError if it is damaged; one that was cut off is read up to there."""
    return LogFile(path)


@dataclass(frozen=True)
class Difference:
    """One number that a log and its replay disagree on."""

    cycle: int  #: counts from 0
    t_s: float
    column: str  #: of the CSV
    recorded: float
    replayed: float


@dataclass(frozen=True)
class Replay:
    """What became of a log's inputs, fed to the controller again."""

    cycles: int
    compared_cycles: int  #: the others cannot be: what the controller knew then is not in the log
    not_replayed: list[dict[str, Any]]  #: stretches of these: `from_s`, `to_s`, `reason`
    is_cut_off: bool  #: any of the logs
    differing_cycles: int
    first_difference: Difference | None
    largest_differences: list[Difference]  #: of dq, u_n, u_j, u_t; only those that differ

    @property
    def is_equal(self) -> bool:
        """Every output that was compared is the recorded one, to the bit."""
        return self.differing_cycles == 0


def _difference(json_difference: dict[str, Any] | None) -> Difference | None:
    if json_difference is None:
        return None
    nan = float("nan")  # which JSON has not
    return Difference(**{name: nan if value is None else value
                         for name, value in json_difference.items()})


def replay(path: Path | Iterable[Path], set: Mapping[str, object] | None = None) -> Replay:
    """Feeds the recorded inputs to the controller and compares its outputs, as `tactus replay` does.

    path: a log, or all logs of a run, the oldest first. set: shows what other values would change of
    the commands, while forces stay as they were recorded.
    """
    paths = [path] if isinstance(path, (str, bytes, os.PathLike)) else list(path)
    answer = json.loads(_core.replay([path_bytes(one) for one in paths], settings(set)))
    largest = [_difference(one) for one in answer["largest_differences"]]
    return Replay(answer["cycles"], answer["compared_cycles"], answer["not_replayed"],
                  answer["cut_off"], answer["differing_cycles"],
                  _difference(answer["first_difference"]), [one for one in largest if one])
