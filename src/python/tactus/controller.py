"""The controller behind any robot or physics engine."""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._settings import is_masked
from .scene import Scene


def _plain(name: str, values: ArrayLike) -> NDArray[Any]:
    rows = values if isinstance(values, (list, tuple)) else [values]
    if any(map(is_masked, rows)):
        raise TypeError(f"{name}: a masked entry in it, expected numbers")
    return np.asarray(values)


def _array(name: str, values: ArrayLike) -> NDArray[np.float64]:
    array = _plain(name, values)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: {array.dtype} in it, expected numbers")
    return array.astype(np.float64, copy=False)


class Controller:
    """The controller of a scene, for one arm. It has a state of its own: of several, each runs alone.

    scene: of which the simulated world counts for nothing. q: where the arm stands at the begin,
    (joints,), m or rad; None: where the scene starts.
    """

    __slots__ = ("_core", "scene")

    def __init__(self, scene: Scene, q: ArrayLike | None = None) -> None:
        if not isinstance(scene, Scene):
            raise TypeError(f"a {type(scene).__name__}, expected a tactus.Scene")
        self.scene = scene
        self._core = _core.make_controller(scene._core, None if q is None else _array("q", q))

    def __copy__(self) -> NoReturn:
        raise TypeError("a controller cannot be copied, both would have one state; make another of the scene")

    def update(self, q_measured: ArrayLike, tactile: ArrayLike | None = None,
               sequence: ArrayLike | None = None) -> NDArray[np.float64]:
        """One cycle: what the sensors say in, joint velocities out. To be called each scene.period_s.

        q_measured: (joints,), m or rad, no farther outside a joint's limits than they are apart.
        tactile: (modules, 4), of each tactile module F_y, F_z (N), M_y, M_z (Nm): what pushes on its
        cover, in its frame and about its origin, see module_poses(). (modules, 5) with M_x last where
        a module of the robot tells that. None: nothing new has come; a sample that gets older than
        max_sample_age_s is a fault.
        sequence: (modules,), counts the samples of each module; the same as before: the same sample.
        None: each that is given is new.

        Returns (joints,), m/s or rad/s: finite and within all limits, to be kept up for a period.
        ValueError names what is wrong with an input; the controller is then as it was before.
        """
        numbers = None
        if sequence is not None:
            numbers = _plain("sequence", sequence)
            if numbers.dtype.kind not in "iu":
                raise TypeError(f"sequence: {numbers.dtype} in it, expected whole numbers")
            if numbers.size and int(numbers.max()) > 0xFFFFFFFF:
                raise ValueError(f"sequence: {numbers.max()}, expected 0 to {0xFFFFFFFF}")
            numbers = numbers.astype(np.int64)
        return self._core.update(_array("q_measured", q_measured),
                                 None if tactile is None else _array("tactile", tactile), numbers)

    def record(self) -> dict[str, Any]:
        """All that the log has of the last cycle, by field: numbers, and arrays of what has several."""
        columns = self._core.record()
        return {field: columns.array(field)[0] for field in columns.units()}

    def module_poses(self, q: ArrayLike) -> NDArray[np.float64]:
        """Frames of the tactile modules in the base frame with the joints at q, (joints,), m or rad.

        (modules, 4, 4): [R p; 0 1], p in m. x points along the link.
        """
        return self._core.module_poses(_array("q", q))

    @property
    def time_s(self) -> float:
        """Of the cycle to come; 0 at first."""
        return self._core.time_s

    @property
    def mode(self) -> str:
        """Of the last cycle, as the daemon names it: running, retreating, holding."""
        return self._core.mode

    @property
    def fault(self) -> str | None:
        """The first fault. From there on the arm leaves the contact if need be, and ramps to rest."""
        return None if self._core.fault == "none" else self._core.fault

    @property
    def is_at_rest(self) -> bool:
        """After a fault: nothing more comes of it."""
        return self._core.is_at_rest

    def __repr__(self) -> str:
        state = self.fault or self.mode
        return f"<tactus.Controller of {self.scene.name!r} at {self.time_s:g} s, {state}>"
