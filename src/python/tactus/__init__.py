"""Tactile feedback control of redundant, position-controlled robot arms: the very controller of tactusd
and `tactus simulate`, with the same numbers to the bit.

    scene = tactus.Scene("scene.yaml", set={"controller.time_constant_s": 0.08})
    run = tactus.simulate(scene)
    run["force_sensor_N"].max()

SI units, radians, base frame unless said otherwise.
"""

import sys as _sys

try:
    from ._core import VERSION as __version__
except ModuleNotFoundError as error:
    raise ImportError(f"tactus is not built for {_sys.executable}, Python {_sys.version.split()[0]}, "
                      "expected Debian's own, /usr/bin/python3") from error
from .controller import Controller
from .daemon import Daemon
from .errors import ConfigError, DaemonError, Error, RunError
from .runs import FAULTS, MODES, Difference, Log, LogFile, Replay, Run, read_log, replay, simulate
from .scene import Scene

__all__ = ["FAULTS", "MODES", "ConfigError", "Controller", "Daemon", "DaemonError", "Difference",
           "Error", "Log", "LogFile", "Replay", "Run", "RunError", "Scene", "__version__", "read_log",
           "replay", "simulate"]
