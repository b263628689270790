"""The runs that are done: DIR/results.jsonl, a line each, that grows only at its end.

Each line is a CRC-32 of what follows, a space, and JSON. The first says what the runs are of. Whatever ends
the writer, at any byte, leaves whole lines and perhaps the beginning of one, which is cut off before the next
is written; a line that is damaged does not count, either. Its run is then done again.
"""

import fcntl
import itertools
import json
import os
import time
import zlib

from .study_text import one_line

NAME = "results.jsonl"
FORMAT = 1
BETWEEN_SYNCS_S = 2.0


class ResultsError(Exception):
    """They cannot be gone on with, or not be written; one line."""

    def __init__(self, text, exit_code):
        super().__init__(one_line(text))
        self.exit_code = exit_code


class Results:
    """`rows` has what is done: {run: row}."""

    def __init__(self, folder, header):
        """Raises ResultsError: of other runs, of another tactus, in use, or what the system says."""
        self.path = folder / NAME
        self.rows = {}
        self.damaged = 0
        self.synced = time.monotonic()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self.file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise ResultsError(f"{self.path}: {error.strerror}, expected a folder to write to", 1) from error
        try:
            self.lock()
            self.begin(header)
        except BaseException:
            os.close(self.file)
            raise

    def lock(self):
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ResultsError(f"{self.path}: another sweep writes to it, expected one at a time", 3) from None

    def begin(self, header):
        with open(self.path, "rb") as file:
            content = file.read()
        whole = content.rfind(b"\n") + 1
        lines = content[:whole].split(b"\n")[:-1]
        if lines:
            self.compare(read_line(lines[0]), header)
            self.read(lines[1:], header["runs"])
        elif content and not line_of(header).startswith(content):
            raise ResultsError(f"{self.path}: no results of a sweep, expected another folder", 1)
        try:
            if whole < len(content):
                os.ftruncate(self.file, whole)
            if not lines:
                self.write(line_of(header))
                self.sync()
        except OSError as error:
            raise self.lost(error) from error

    def compare(self, old, new):
        if not isinstance(old, dict) or old.get("format") != FORMAT or "runs" not in old:
            raise ResultsError(f"{self.path}:1: no results of a sweep, or damaged, expected another folder", 1)
        for name, value in new["tactus"].items():
            if old["tactus"].get(name) != value:
                raise ResultsError(f"{self.path}: of another tactus, {name} {old['tactus'].get(name)}, this one "
                                   f"is {value}; expected that one, or another folder", 1)
        difference = first_difference(old, new)
        if difference:
            raise ResultsError(f"{self.path}: of other runs: {difference}; expected the same study, or another "
                               "folder", 1)

    def read(self, lines, runs):
        for line in lines:
            row = read_line(line)
            if not isinstance(row, dict) or not isinstance(row.get("run"), int) or not 0 <= row["run"] < runs:
                self.damaged += 1
            else:
                self.rows.setdefault(row["run"], row)

    def add(self, rows):
        """Only what is not there yet. Raises ResultsError."""
        new = {row["run"]: row for row in rows if row["run"] not in self.rows}
        if not new:
            return
        try:
            self.write(b"".join(map(line_of, new.values())))
            if time.monotonic() - self.synced > BETWEEN_SYNCS_S:
                self.sync()
        except OSError as error:
            raise self.lost(error) from error
        self.rows |= new

    def write(self, content):
        done = os.write(self.file, content)
        if done < len(content):
            raise OSError(28, "No space left on device")

    def sync(self):
        os.fsync(self.file)
        self.synced = time.monotonic()

    def close(self):
        try:
            self.sync()
        except OSError as error:
            raise self.lost(error) from error
        finally:
            os.close(self.file)

    def lost(self, error):
        return ResultsError(f"{self.path}: cannot be written ({error.strerror}); the runs before are kept, and "
                            "the same command goes on", 3)


def line_of(value):
    text = json.dumps(value, separators=(",", ":")).encode()
    return b"%08x %s\n" % (zlib.crc32(text), text)


def read_line(line):
    """None of one that is damaged."""
    try:
        if len(line) < 10 or int(line[:8], 16) != zlib.crc32(line[9:]):
            return None
        return json.loads(line[9:])
    except (ValueError, RecursionError):
        return None


def header_of(plan, identity):
    """What makes the runs what they are."""
    return {"format": FORMAT, "tactus": identity, "runs": plan.runs, **plan.as_json()}


def first_difference(old, new):
    for number, (was, is_) in enumerate(zip(old["scenes"], new["scenes"])):
        difference = file_difference(dict(was), dict(is_))
        if difference:
            return difference
    if len(old["scenes"]) != len(new["scenes"]):
        return f"{len(old['scenes'])} scenes, now {len(new['scenes'])}"
    for name, was, is_ in (("set", [old["fixed"]], [new["fixed"]]),
                           *zip(("grid", "points", "disturbances"), old["parts"], new["parts"])):
        if was != is_:
            return f"{name}: {list_difference(was, is_)}"
    return None


def file_difference(was, is_):
    if list(was) != list(is_):
        return list_difference([list(was)], [list(is_)])
    for path, text in was.items():
        if text != is_[path]:
            number, difference = line_difference(text.split("\n"), is_[path].split("\n"))
            return f"{path}:{number}: {difference}"
    return None


def list_difference(was, is_):
    """Of the first choices that differ."""
    if len(was) != len(is_):
        return f"{len(was)} choices, now {len(is_)}"
    return next(line_difference(old, new)[1] for old, new in zip(was, is_) if old != new)


def line_difference(was, is_):
    """Number and text of the first lines that differ. What was put in between is not looked for: it takes minutes
    of a long file."""
    for number, (old, new) in enumerate(itertools.zip_longest(was, is_), 1):
        if old != new:
            return number, f"was {quoted(old)}, is {quoted(new)}"
    return None


def quoted(line):
    return "nothing" if line is None else f"'{line}'"
