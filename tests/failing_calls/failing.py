"""What tests of failing calls share: the programs, the places at which calls fail, and what was found before."""
import bisect
import functools
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
TACTUS, TACTUSD, LIBRARY, VIRTUAL = (str(pathlib.Path(sys.argv.pop(1)).resolve()) for _ in range(4))
FOUND = os.environ.get("TACTUS_FAILING_CALLS_FOUND")
END_S = time.monotonic() + float(os.environ.get("TACTUS_FAILING_CALLS_S", "inf"))
MOST = int(os.environ.get("TACTUS_FAILING_CALLS", "4"))
PATIENCE_S = 20
NOT_AGAIN = "did not come by that way again"


def spread(those, most=MOST):
    """Which of them fail: all, in an order in which the first are a sample, or as many as may be, the first and the
    last among them."""
    if most == 0:
        return random.Random(1).sample(those, len(those))
    if len(those) <= most:
        return list(those)
    return [those[i] for i in sorted({i * (len(those) - 1) // (most - 1) for i in range(most)})]


@functools.lru_cache
def found_before():
    lines = pathlib.Path(FOUND).read_text().splitlines() if FOUND and os.path.exists(FOUND) else []
    return {key: found for key, *found in map(json.loads, lines)}


def tried(key, try_it):
    """[(outcome, trouble)], as it was found before, or now; [] if there is no time left."""
    if key in found_before():
        return [found_before()[key]]
    if time.monotonic() > END_S:
        return []
    found = try_it()
    if FOUND:
        with open(FOUND, "a") as file:
            file.write(json.dumps([key, *found]) + "\n")
    return [found]


@functools.lru_cache
def symbols(library):
    """Addresses and names of its functions."""
    listed = []
    for option in ([], ["-D"]):
        said = subprocess.run(["nm", "-nC", "--defined-only", *option, library], capture_output=True, text=True,
                              check=False).stdout
        listed += [(int(at, 16), name) for at, kind, name in re.findall("^([0-9a-f]+) ([A-Za-z]) (.*)$", said, re.M)
                   if kind in "tTwW"]
    return sorted(listed)


def place_of(folder, program):
    """The functions in which the call failed, innermost first; [] if none has failed."""
    names = []
    for line in pathlib.Path(folder, "place").read_text().rstrip("\0").splitlines():
        library, offset = line.rsplit(" ", 1)
        library = program if library == "-" else library
        there = symbols(library)
        at = bisect.bisect_right(there, (int(offset, 16), "~")) - 1
        names.append(f"{pathlib.Path(library).name}: {there[at][1] if at >= 0 else '?'}")
    return names


def known_outcome(returncode, said, place):
    """What libraries do that ask for memory where they may not throw; None if it is none of these. Constants before
    main(), and CLI11's search for an option: before a file is read. And nlohmann-json 3.11's destructor."""
    if returncode != -6 or "std::bad_alloc" not in said:
        return None
    if any("nlohmann" in name and ("~basic_json" in name or "destroy" in name) for name in place):
        return "aborts in the destructor of nlohmann-json"
    if any("_GLOBAL__sub_I" in name or "CLI::" in name for name in place):
        return "aborts before it has read a file"
    return None
