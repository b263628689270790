"""A client of the running daemon: docs/control.md says what becomes of what is asked."""

from __future__ import annotations

import contextlib
import errno
import json
import math
import os
import pathlib
import socket
import threading
import time
from collections.abc import Iterable, Mapping, Sequence, Set
from types import TracebackType
from typing import Any

import numpy as np

from ._settings import is_masked
from .errors import DaemonError, RunError
from .scene import Scene

_MAX_REQUEST = 1 << 15
_MAX_ANSWER = 1 << 18
_MAX_STATUS_AGE_S = 2.0
_UNDER_WAY = ("moving", "blocked")
_Point = Sequence[float | None]


class Daemon:
    """A connection to the control socket of tactusd, AF_UNIX; close it, or use it in a `with`.

    path: of the socket; None: /run/tactus/control, or in the folder that RUNTIME_DIRECTORY names, as of
    the commands. timeout_s: how long an answer may take. RunError: no daemon runs, it may not
    be asked, or does not answer; then a new connection is needed. DaemonError: it refuses.

    Threads may share it: each gets the answer to its own request, one after the other. So may a handler of a
    signal, which need not wait for the request that it interrupts: its own takes another connection.
    """

    def __init__(self, path: str | os.PathLike[str] | None = None,
                 timeout_s: float = 10.0) -> None:
        folder = os.environ.get("RUNTIME_DIRECTORY") or "/run/tactus"
        self.path = os.path.join(folder, "control") if path is None else os.fspath(path)
        self._socket: socket.socket | None = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket.settimeout(timeout_s)
        self._timeout_s = timeout_s
        self._turn = threading.RLock()  # a handler of a signal that holds the arm may not wait for itself
        self._waiting: int | None = None  # thread whose request is on its way
        try:
            self._socket.connect(self.path)
        except (FileNotFoundError, ConnectionRefusedError) as error:
            self.close()
            raise RunError(f"{self.path}: no daemon is running here; `journalctl -u tactusd` says how "
                           "a service ended, RUNTIME_DIRECTORY leads to any other") from error
        except OSError as error:
            self.close()
            raise RunError(f"{self.path}: {error.strerror or error}") from error

    def close(self) -> None:
        """Ends the connection; the daemon goes on, and so does a motion that it was told."""
        if self._socket is not None:
            self._socket.close()
        self._socket = None

    def __enter__(self) -> Daemon:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def ask(self, request: Mapping[str, object]) -> dict[str, Any]:
        """One request of docs/control.md as it stands there, and its answer."""
        text = json.dumps(dict(request), allow_nan=False, default=_plain)
        if self._waiting == threading.get_ident():  # in a handler of a signal
            with Daemon(self.path, self._timeout_s) as other:
                return other.ask(request)
        with self._turn:  # an answer does not say to which request
            try:
                self._waiting = threading.get_ident()
                packet = self._exchange(text.encode())
            finally:
                self._waiting = None
        try:
            answer = json.loads(packet)
        except ValueError:
            answer = None
        if not isinstance(answer, dict) or "done" not in answer:
            self.close()
            raise RunError(f"{self.path}: " + ("not the answer of a daemon" if packet else
                                               "the daemon has ended the connection"))
        if answer["done"] is not True:
            raise DaemonError(answer.get("error", "refused"))
        return answer

    def _exchange(self, packet: bytes) -> bytes:
        if self._socket is None:
            raise ValueError("the connection is closed, expected a new tactus.Daemon")
        try:
            with contextlib.suppress(BrokenPipeError):  # refused before it was asked, and why has come
                self._socket.send(packet)
            return self._socket.recv(_MAX_ANSWER)
        except OSError as error:
            if error.errno == errno.EMSGSIZE:  # nothing was sent
                raise ValueError(f"a request of {len(packet)} bytes, expected at most {_MAX_REQUEST}") from error
            self.close()  # an answer that comes late would be taken for the next one
            raise RunError(f"{self.path}: the daemon does not answer: {error}") from error
        except BaseException:  # Ctrl-C, likewise
            self.close()
            raise

    def status(self) -> dict[str, Any]:
        """What `tactus status --json` prints: mode, fault, force, times of the loop."""
        path = pathlib.Path(self.path).parent / "status.json"
        try:
            status = json.loads(path.read_text())
            age_s = time.monotonic() - status["monotonic_s"]
        except OSError as error:
            raise RunError(f"{path}: {error.strerror}") from error
        except (ValueError, KeyError, TypeError) as error:
            raise RunError(f"{path}: not the status of a daemon") from error
        if age_s < 0.0:  # the clock was another
            raise RunError(f"{path}: is of before this computer started")
        if not age_s <= _MAX_STATUS_AGE_S:
            raise RunError(f"{path}: no word from the daemon for {age_s:.0f} s")
        return status  # type: ignore[no-any-return]

    def show(self) -> dict[str, Any]:
        """Gains, the state of the last change, and of the task."""
        return self.ask({"do": "show"})

    def set(self, values: Mapping[str, float | str | None], for_s: float | None = None,
            wait: bool = False) -> dict[str, Any]:
        """Changes gains, all of these or none. for_s: they go back after so long, 0.001 to 86400 s.

        Returns the last answer, with `changes`: when the gains are there, or wait for a moment without
        contact; with `wait` when they are kept, for which the arm has to have been in contact for a while,
        or went back, of which `trouble` says why. A DaemonError where another change comes before that.
        """
        return self._change(_without_none({"do": "set", "values": dict(values), "for_s": for_s}), wait)

    def reload(self, for_s: float | None = None, wait: bool = False) -> dict[str, Any]:
        """Takes the gains of the daemon's scene file anew; else as set()."""
        return self._change(_without_none({"do": "reload", "for_s": for_s}), wait)

    def undo(self, wait: bool = False) -> dict[str, Any]:
        """What ran before the last change; up to 16 times. Else as set()."""
        return self._change({"do": "undo"}, wait)

    def diff(self) -> dict[str, dict[str, float | None]]:
        """Gains that run and that the scene file does not have, by key: `file`, `running`.

        None: no limit. Reads the daemon's scene file, which has to be on this machine.
        """
        answer = self.show()
        ordered = answer["ordered"]
        file = {key: value if abs(value) != float("inf") else None
                for key, value in Scene(answer["scene"]).gains.items()}
        return {key: {"file": file[key], "running": ordered[key]} for key in ordered
                if key in file and file[key] != ordered[key]}

    def move(self, to_m: _Point | None = None, rotate_rad: _Point | None = None, *,
             relative: bool = False, to_posture: bool = False, speed_m_per_s: float | None = None,
             speed_rad_per_s: float | None = None, wait: bool = False) -> dict[str, Any]:
        """Tells the tool where to go: to_m, base frame, None for one that stays; rotate_rad, axis times
        angle, base frame; at least one of them. relative: both from where the tool is. to_posture: instead
        of these to where it is in redundancy.posture; the joints may get there later, which "posture" of
        task() tells.

        Returns the task; with `wait` when the tool has arrived, was given up, or stopped. Ctrl-C ends the
        waiting alone: hold() stops the tool.
        """
        if not isinstance(to_posture, (bool, np.bool_)):
            raise TypeError(f"to_posture: {to_posture!r}, expected True or False")
        posture = {"to_posture": True} if to_posture else {}
        return self._tell({"do": "move", **posture, **_target(to_m, rotate_rad, relative, speed_m_per_s,
                                                              speed_rad_per_s)}, wait)

    def follow(self, waypoints: Iterable[Mapping[str, object]], wait: bool = False) -> dict[str, Any]:
        """Waypoints as of docs/control.md, such as {"to_m": [0.9, 0.4, 0.25], "pause_s": 1}."""
        return self._tell({"do": "follow", "waypoints": [dict(point) for point in waypoints]}, wait)

    def stream(self, to_m: _Point | None = None, rotate_rad: _Point | None = None, *,
               relative: bool = False, speed_m_per_s: float | None = None,
               speed_rad_per_s: float | None = None) -> dict[str, Any]:
        """As move(), 25 to 500 times a second; if the next does not come in time, the tool stops."""
        return self._tell({"do": "stream", **_target(to_m, rotate_rad, relative, speed_m_per_s,
                                                     speed_rad_per_s)}, False)

    def hold(self) -> dict[str, Any]:
        """The tool comes to rest where it is."""
        return self._tell({"do": "hold"}, False)

    def task(self) -> dict[str, Any] | None:
        """Where the tool is and goes; None of a scene whose task is a trajectory."""
        return self.show()["task"]  # type: ignore[no-any-return]

    def _change(self, request: Mapping[str, object], until_kept: bool) -> dict[str, Any]:
        answer = self.ask(request)
        number, changes = answer["number"], answer["changes"]
        on_its_way = {"ramping", "going_back"} | ({"waiting", "on_trial"} if until_kept else set())
        # Also an order in which nothing differs is on its way; a reload without one answers as it is.
        while changes or answer["state"] == "waiting":
            time.sleep(0.1)  # the loop takes an order within some cycles
            answer = self.show()
            if answer["number"] != number:  # what it tells is not of ours
                raise DaemonError("another change has come meanwhile, which may have taken this one back")
            if answer["state"] not in on_its_way:
                break
        return answer | {"changes": changes}

    def _tell(self, request: Mapping[str, object], wait: bool) -> dict[str, Any]:
        task: dict[str, Any] = self.ask(request)["task"]
        number = task["number"]
        while wait and (task["state"] in _UNDER_WAY or task["waiting"] > 0):
            time.sleep(0.05)
            task = self.show()["task"]
            if task["number"] != number:
                raise DaemonError("another order has taken the place of this one")
        return task


def _without_none(request: Mapping[str, object]) -> dict[str, object]:
    return {key: value for key, value in request.items() if value is not None}


def _plain(value: object) -> object:
    """Of NumPy's numbers and arrays, for which JSON has no word."""
    if isinstance(value, (np.generic, np.ndarray)) and not is_masked(value):
        return value.tolist()
    raise TypeError(f"{value!r}: a {type(value).__name__}, expected numbers, texts, bools, None, or lists "
                    "or mappings of these")


def _numbers(name: str, point: _Point | None) -> list[float | None] | None:
    """Text is refused: "123" would be three numbers. So is what has no order, or keys in place of numbers."""
    if isinstance(point, (Mapping, Set)):
        raise TypeError(f"{name}: a {type(point).__name__}, expected a list of numbers")
    return None if point is None else [None if x is None else _number(name, x) for x in point]


def _number(name: str, value: object) -> float:
    array = np.asarray(value)
    if array.ndim != 0 or array.dtype.kind not in "fiu" or is_masked(value):
        raise TypeError(f"{name}: {value!r} in it, expected numbers, or None for what stays")
    if not math.isfinite(array):
        raise ValueError(f"{name}: {value} in it, expected finite numbers")
    return float(array)


def _target(to_m: _Point | None, rotate_rad: _Point | None, relative: bool,
            speed_m_per_s: float | None, speed_rad_per_s: float | None) -> dict[str, object]:
    if not isinstance(relative, (bool, np.bool_)):  # any text would be true, "no" as well
        raise TypeError(f"relative: {relative!r}, expected True or False")
    target = {"to_m": _numbers("to_m", to_m), "rotate_rad": _numbers("rotate_rad", rotate_rad),
              "relative": True if relative else None, "speed_m_per_s": speed_m_per_s,
              "speed_rad_per_s": speed_rad_per_s}
    return _without_none(target)
