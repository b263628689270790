#!/usr/bin/python3
"""Turns a Debian root into an initramfs (cpio, "newc"), so that it boots without a disk and its
drivers, and without rights on this machine.

usage: root_image.py ROOT.tar OVERLAY IMAGE    OVERLAY: a folder laid over the root, owned by root"""

import os
import stat
import sys
import tarfile
from pathlib import Path


class Image:
    def __init__(self, file):
        self.file = file
        self.entries = 0

    def add(self, path, mode, contents=b"", uid=0, gid=0, mtime=0):
        self.entries += 1
        name = path.encode() + b"\0"
        fields = [self.entries, mode, uid, gid, 1, mtime, len(contents), 0, 0, 0, 0, len(name), 0]
        self._padded(b"070701" + b"".join(b"%08x" % field for field in fields) + name)
        self._padded(contents)

    def _padded(self, data):
        self.file.write(data + bytes(-len(data) % 4))


def kind(member):
    if member.isdir():
        return stat.S_IFDIR
    return stat.S_IFLNK if member.issym() else stat.S_IFREG


def add_root(image, root, replaced):
    for member in root:
        path = member.name.removeprefix("./").rstrip("/")
        is_known = member.isfile() or member.islnk() or member.isdir() or member.issym()
        if path in ("", ".") or path in replaced or not is_known:
            continue  # devices: the kernel makes them
        contents = member.linkname.encode() if member.issym() else b""
        if member.isfile() or member.islnk():
            contents = root.extractfile(member).read()
        mode = kind(member) | (0o777 if member.issym() else member.mode)
        image.add(path, mode, contents, member.uid, member.gid, int(member.mtime))


def add_overlay(image, overlay, existing):
    for file in sorted(overlay.rglob("*")):
        path = str(file.relative_to(overlay))
        status = file.lstat()
        if file.is_symlink():
            image.add(path, stat.S_IFLNK | 0o777, os.readlink(file).encode())
        elif file.is_file():
            image.add(path, status.st_mode, file.read_bytes(), mtime=int(status.st_mtime))
        elif path not in existing:
            image.add(path, stat.S_IFDIR | 0o755)


def main():
    root_tar, overlay, output = (Path(argument) for argument in sys.argv[1:])
    replaced = {str(file.relative_to(overlay)) for file in overlay.rglob("*")
                if file.is_symlink() or file.is_file()}
    with tarfile.open(root_tar) as root, open(output, "wb") as file:
        image = Image(file)
        add_root(image, root, replaced)
        add_overlay(image, overlay, {name.removeprefix("./").rstrip("/") for name in root.getnames()})
        image.add("TRAILER!!!", 0)


if __name__ == "__main__":
    main()
