"""What can go wrong. All other mistakes of a caller, such as arrays of a wrong shape, are ValueError or
TypeError, and name what was expected."""

from __future__ import annotations


class Error(Exception):
    """Of all errors of this module alone."""


class ConfigError(Error, ValueError):
    """Something is wrong with a scene, a robot, a URDF, a value set, or a log.

    str() is the line that the commands print: `file:line:column: key: what is wrong, what is expected`.
    """

    file: str | None  #: None: no place is known
    line: int | None  #: counts from 1
    column: int | None  #: counts from 1, bytes
    key: str | None  #: dotted; "-" of no key

    def __init__(self, message: str, file: str | None = None, line: int | None = None,
                 column: int | None = None, key: str | None = None) -> None:
        super().__init__(message)
        self.file, self.line, self.column, self.key = file, line, column, key

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        return type(self), (str(self), self.file, self.line, self.column, self.key)


class RunError(Error, RuntimeError):
    """Something went wrong although the input was good: a lost file, no daemon, one that is silent."""


class DaemonError(Error):
    """The daemon refuses; str() is its line that says why."""
