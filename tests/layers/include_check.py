#!/usr/bin/python3
"""Refuses an #include that runs against the arrows between the layers:

    math -> control -> {sim, canopen}        sim -> analysis        {sim, canopen} -> plant
    canopen -> supervisor -> {io, commission}    {io, rt} -> doctor
    {analysis, plant} -> scene               {scene, supervisor} -> record
    record -> run -> python                  {record, io, rt} -> daemon -> panel
    {run, daemon, doctor, commission} -> cli -> bench

usage: include_check.py ROOT     checks ROOT/include/tactus/** and ROOT/src/**"""

import pathlib
import re
import sys

# What a layer may use: other layers, and the first folder (or whole name) of a library's headers.
LAYERS = {
    "math": (set(), {"Eigen"}),
    "control": ({"math"}, {"Eigen"}),
    "sim": ({"control", "math"}, {"Eigen"}),
    "analysis": ({"sim", "control", "math"}, {"Eigen", "unsupported"}),  # Eigen's exp of matrices
    "canopen": ({"control", "math"}, {"Eigen"}),
    "supervisor": ({"canopen", "control", "math"}, {"Eigen"}),
    "commission": ({"supervisor", "canopen", "control", "math"}, {"Eigen"}),
    "plant": ({"canopen", "sim", "control", "math"}, {"Eigen"}),
    "io": ({"supervisor", "canopen", "control", "math"}, {"Eigen", "gpiod.h", "systemd"}),
    "rt": ({"math"}, {"seccomp.h", "malloc.h"}),
    "scene": ({"analysis", "plant", "canopen", "sim", "control", "math"},
              {"Eigen", "yaml-cpp", "pugixml.hpp", "fmt", "nlohmann"}),
    "record": ({"supervisor", "scene", "plant", "canopen", "sim", "control", "math"},
               {"Eigen", "fmt", "nlohmann"}),
    "run": ({"record", "supervisor", "scene", "analysis", "canopen", "sim", "control", "math"},
            {"Eigen", "fmt", "nlohmann"}),
    "doctor": ({"io", "rt", "canopen", "math"}, {"fmt"}),
    "daemon": ({"record", "supervisor", "scene", "io", "rt", "canopen", "control", "math"},
               {"Eigen", "CLI", "fmt", "nlohmann", "systemd"}),
    "cli": ({"commission", "run", "daemon", "doctor", "record", "supervisor", "scene", "io", "rt", "analysis", "plant",
             "canopen", "sim", "control", "math"}, {"Eigen", "CLI", "fmt", "nlohmann"}),
    "panel": ({"daemon", "record", "supervisor", "scene", "control", "math"},
              {"Eigen", "CLI", "fmt", "malloc.h", "nlohmann"}),
    "python": ({"run", "record", "scene", "control", "math"},
               {"Eigen", "cxxabi.h", "fmt", "nlohmann", "pybind11"}),
    "bench": ({"cli", "run", "record", "supervisor", "scene", "analysis", "sim", "control", "math"},
              {"Eigen", "CLI", "fmt", "kdl", "mujoco", "nlohmann", "valgrind"}),
}

# The standard library is open to every layer but for these: what the cycle runs gets time and input
# as arguments, never by a call.
SIDE_EFFECTS = {"chrono", "ctime", "thread", "mutex", "shared_mutex", "condition_variable",
                "future", "filesystem", "fstream", "iostream", "cstdio", "csignal"}
PURE_LAYERS = {"math", "control", "sim", "analysis", "canopen", "supervisor", "commission",
               "plant"}

POSIX = re.compile(r"(sys|linux|net|netinet|arpa)/.+|"
                   r"(unistd|fcntl|poll|pthread|sched|semaphore|signal|stdlib|termios|time|errno)\.h")
SOCKETS = re.compile(r"(sys/(socket|un)|linux/can.*|net/.+|netinet/.+|arpa/.+|netdb)(\.h)?")
POSIX_LAYERS = {"io", "rt", "record", "daemon", "cli", "panel", "bench"}
SOCKET_LAYERS = {"io"}
# The one listener besides, of a program of its own: a single file knows the library.
LISTENER = ("httplib.h", "src/panel/panel_server.cpp")

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]*)[>"]')
ANY_INCLUDE = re.compile(r"^\s*#\s*include\b")


def violations(root):
    """A line for each finding, `file:line: what is wrong`, and the number of files looked at."""
    found = []
    sources = [path for folder in ("include/tactus", "src")
               for path in sorted((root / folder).rglob("*")) if path.is_file()]
    for path in sources:
        parts = path.relative_to(root).parts
        layer = parts[2] if parts[0] == "include" else parts[1]
        if layer not in LAYERS:
            found.append(f"{path}:1: folder {layer} is no layer, expected one of {sorted(LAYERS)}")
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if ANY_INCLUDE.match(line):
                problem = judge(layer, line, path)
                found += [f"{path}:{number}: {problem}"] if problem else []
    return found, len(sources)


def judge(layer, line, path):
    """What is wrong with this #include of a file of this layer; None if nothing."""
    match = INCLUDE.match(line)
    if not match:
        return "include of a macro, expected a name"
    quote, header = match.groups()
    if header.startswith("tactus/"):
        target = header.split("/")[1]
        return None if target in LAYERS[layer][0] | {layer} else f"{layer} must not use {target} ({header})"
    if quote == '"':
        beside = "/" not in header and (path.parent / header).is_file()
        return None if beside else f"{header} is neither tactus/... nor beside the file"
    if "/" not in header and "." not in header and header != "Eigen":
        impure = layer in PURE_LAYERS and header in SIDE_EFFECTS
        return f"{layer} must not use <{header}>: time and input are arguments" if impure else None
    if header == LISTENER[0] and layer == "panel" and path.as_posix().endswith("/" + LISTENER[1]):
        return None
    if header.split("/")[0] in LAYERS[layer][1]:
        return None
    if SOCKETS.fullmatch(header):
        return None if layer in SOCKET_LAYERS else f"{layer} must not use sockets (<{header}>)"
    if POSIX.fullmatch(header):
        return None if layer in POSIX_LAYERS else f"{layer} must not use POSIX (<{header}>)"
    return f"{layer} must not use <{header}>: not among its libraries"


def main():
    found, count = violations(pathlib.Path(sys.argv[1]))
    print("\n".join(found) or f"{count} files, every include follows the arrows")
    if not count:
        print("no source found", file=sys.stderr)
    return 1 if found or not count else 0


if __name__ == "__main__":
    sys.exit(main())
