"""Values of Python as the commands' --set takes them, and paths as the loader does."""

from __future__ import annotations

import json
import numbers
import os
from collections.abc import Mapping

import numpy as np

Path = str | os.PathLike[str]


def path_bytes(path: Path) -> bytes:
    name = os.fsencode(path)
    if b"\0" in name:
        raise ValueError(f"{path!r}: a null in a path, expected the path of a file")
    return name


def is_masked(value: object) -> bool:
    """NumPy's conversions leave the mask out, so that what it hides would count."""
    return isinstance(value, np.ma.MaskedArray) and bool(np.any(value.mask))


def settings(values: Mapping[str, object] | None) -> list[bytes]:
    """KEY=VALUE each. A text is taken as on the command line."""
    if values is None:
        return []
    if not isinstance(values, Mapping):
        raise TypeError(f"set is a {type(values).__name__}, expected a mapping of keys to values")
    return [f"{_key(key)}={value if isinstance(value, str) else _yaml(key, value)}".encode(
        "utf-8", "surrogateescape") for key, value in values.items()]


def _key(key: object) -> str:
    if not isinstance(key, str) or "=" in key:
        raise TypeError(f"set: {key!r} is no key, expected text such as 'controller.damping'")
    return key


def _yaml(key: str, value: object) -> str:
    """In YAML's flow style."""
    if is_masked(value):
        raise TypeError(f"set: {key} has a masked entry, expected a number")
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if value is None:
        return "null"
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        text = repr(float(value))
        return {"inf": ".inf", "-inf": "-.inf", "nan": ".nan"}.get(text, text)
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_quoted(_key(k))}: {_yaml(key, v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_yaml(key, v) for v in value) + "]"
    raise TypeError(f"set: {key} is a {type(value).__name__}, expected a number, a text, a bool, None, "
                    "or a list or mapping of these")


def _quoted(text: str) -> str:
    """Without JSON's pairs of surrogates, which are no characters of YAML."""
    return json.dumps(text, ensure_ascii=False)
