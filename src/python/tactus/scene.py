"""Scenes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._settings import Path, path_bytes, settings


class Scene:
    """A scene with everything that it names: robot, URDF, and what it extends.

    path: of the scene's YAML file. set: values laid over it, as `tactus simulate --set` does, e.g.
    {"controller.time_constant_s": 0.08, "task": None}. A text is taken as on the command line.

    Every value is checked; ConfigError tells of the first that is wrong. The files are read once, here.
    It never changes, and threads may share it.
    """

    __slots__ = ("_core",)

    def __init__(self, path: Path, set: Mapping[str, object] | None = None) -> None:
        self._core = _core.load_scene(path_bytes(path), settings(set))

    def check(self) -> dict[str, Any]:
        """What `tactus check --json` prints: stages, joints, margins, expected forces, bus loads. What
        is infinite is None.

        ConfigError as of the command: it also looks at buses, drives and stability.
        """
        return json.loads(self._core.check())  # type: ignore[no-any-return]

    @property
    def name(self) -> str:
        """Of the file, without .yaml."""
        return self._core.name

    @property
    def robot(self) -> str:
        """As the URDF names it."""
        return self._core.robot

    @property
    def variant(self) -> str:
        """Of the law; "none" without force control."""
        return self._core.variant

    @property
    def files(self) -> list[str]:
        """The scene first, then what it extends, the robot, the URDF."""
        return self._core.files()

    @property
    def period_s(self) -> float:
        """Of a cycle."""
        return self._core.period_s

    @property
    def duration_s(self) -> float:
        """Of a simulation."""
        return self._core.duration_s

    @property
    def joints(self) -> list[str]:
        """Names, from the base to the tool."""
        return self._core.joints

    @property
    def modules(self) -> list[str]:
        """The link of each tactile module that the controller reads."""
        return self._core.modules

    @property
    def q_start(self) -> NDArray[np.float64]:
        """Where a run starts: (joints,), m or rad."""
        return self._core.q_start

    @property
    def gains(self) -> dict[str, float]:
        """All that may be tuned while an arm runs, by key; inf: no limit."""
        return self._core.gains()

    @property
    def numbers(self) -> dict[str, float]:
        """Every number of the scene and, without the `robot.` of `set`, of robot.yaml, by key; defaults
        included."""
        return self._core.numbers()

    def __repr__(self) -> str:
        return f"<tactus.Scene {self.name!r}, {len(self.joints)} joints, variant {self.variant}>"
