"""Writes an initramfs (cpio, "newc") that depends on the contents alone: neither on times, owners
and inode numbers nor on the order of a folder. Needs no root and no staging folder."""

import os
import re
import subprocess
from pathlib import Path

FOLDER, FILE, LINK = 0o040755, 0o100644, 0o120777


class Initramfs:
    def __init__(self):
        self._entries = {}  # path without leading slash -> (mode, contents)

    def add_folder(self, path):
        path = path.strip("/")
        if path and path not in self._entries:
            self.add_folder(os.path.dirname(path))
            self._entries[path] = (FOLDER, b"")

    def _add(self, path, mode, contents):
        self.add_folder(os.path.dirname(path))
        self._entries[path.strip("/")] = (mode, contents)

    def add_file(self, path, contents, executable=False):
        self._add(path, FILE | (0o111 if executable else 0), contents)

    def add_link(self, path, target):
        self._add(path, LINK, target.encode())

    def add_tree(self, path, source):
        for file in sorted(Path(source).rglob("*")):
            if file.is_file():
                inner = f"{path}/{file.relative_to(source)}"
                self.add_file(inner, file.read_bytes(), os.access(file, os.X_OK))

    def add_program(self, source, folder="/usr/bin"):
        """With its libraries and the dynamic linker, each where the program looks for it."""
        source = Path(source)
        self.add_file(f"{folder}/{source.name}", source.read_bytes(), executable=True)
        for library in libraries(source):
            self.add_file(library, Path(library).read_bytes(), executable=True)

    def bytes(self):
        packed = b"".join(
            _record(number, path, *self._entries[path])
            for number, path in enumerate(sorted(self._entries), start=1)
        )
        return packed + _record(0, "TRAILER!!!", 0, b"")


def libraries(program):
    done = subprocess.run(["ldd", program], text=True, capture_output=True, check=False)
    if "not a dynamic executable" in done.stderr or "statically linked" in done.stdout:
        return []
    if done.returncode != 0 or "not found" in done.stdout:
        raise RuntimeError(f"{program}: libraries are missing: {done.stdout}{done.stderr}")
    return re.findall(r"(/\S+) \(0x", done.stdout)


def _padded(data):
    return data + b"\0" * (-len(data) % 4)


def _record(inode, path, mode, contents):
    name = path.encode() + b"\0"
    links, owner, group, time = 1, 0, 0, 0
    fields = [inode, mode, owner, group, links, time, len(contents), 0, 0, 0, 0, len(name), 0]
    header = b"070701" + b"".join(b"%08x" % field for field in fields)
    return _padded(header + name) + _padded(contents)
