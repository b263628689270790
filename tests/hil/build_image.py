#!/usr/bin/python3
"""Builds what the virtual machine starts from: kernel, initramfs and the table of the GPIO chips.

usage: build_image.py FOLDER [--program FILE]... [--folder PATH=SOURCE]... [--cache FOLDER]

The initramfs holds busybox, the tools that guest scripts use, each --program (with its libraries,
in /usr/bin), each --folder (contents of SOURCE at PATH) and guest/ at /guest. The same input gives
the same bytes."""

import argparse
import shutil
import subprocess
import sys
from pathlib import Path

from initramfs import Initramfs
from kernel_package import MODULES, kernel_folder

HERE = Path(__file__).resolve().parent
CACHE = HERE.parents[1] / "build" / "hil"
TOOLS = ["candump", "cansend", "cangen", "chrt", "cyclictest", "gpiodetect", "gpioget", "gpioinfo",
         "gpiomon", "gpioset", "ip", "strace", "tc"]  # fmt: skip
SYSTEM_FOLDERS = ["dev", "proc", "sys", "tmp", "out", "root"]


def installed(program):
    path = shutil.which(program, path="/usr/bin:/bin:/usr/sbin:/sbin")
    if path is None:
        raise RuntimeError(f"{program} is missing; tools/setup installs what the tests need")
    return path


def compiled(source, folder):
    program = folder / source.stem
    subprocess.run(["cc", "-O2", "-s", "-static", "-o", program, source], check=True)
    return program


def stripped(program, folder):
    """A copy without what is for debuggers alone: the guest has all files in its memory."""
    copy = folder / Path(program).name
    subprocess.run(["strip", "-o", copy, program], check=True)
    return copy


def initramfs(folder, kernel, programs, folders):
    image = Initramfs()
    for name in SYSTEM_FOLDERS:
        image.add_folder(name)
    image.add_file("/init", (HERE / "guest" / "init").read_bytes(), executable=True)
    image.add_tree("/guest", HERE / "guest")
    modules = [f"{Path(module).name}.ko" for module in MODULES]
    image.add_file("/modules/order", "".join(f"{name}\n" for name in modules).encode())
    for name in modules:
        image.add_file(f"/modules/{name}", (kernel / name).read_bytes())

    busybox = installed("busybox")
    image.add_program(busybox, "/bin")
    listing = subprocess.run([busybox, "--list"], text=True, capture_output=True, check=True)
    for applet in set(listing.stdout.split()) - {"busybox"}:
        image.add_link(f"/bin/{applet}", "busybox")
    # Busybox's own shell prefers its applets to programs of the same name in PATH.
    image.add_program(installed("dash"), "/bin")
    image.add_link("/bin/sh", "dash")
    own = [compiled(source, folder) for source in sorted((HERE / "guest").glob("*.c"))]
    own += [stripped(program, folder) for program in programs]
    for program in [installed(tool) for tool in TOOLS] + own:
        image.add_program(program)
    for path, source in folders:
        image.add_tree(path, source)
    return image.bytes()


def build(folder, programs=(), folders=(), cache=CACHE):
    """Writes vmlinux, initrd and gpio.aml into the folder, which has to exist."""
    folder = Path(folder)
    kernel = kernel_folder(Path(cache))
    shutil.copyfile(kernel / "vmlinux", folder / "vmlinux")
    (folder / "initrd").write_bytes(initramfs(folder, kernel, list(programs), folders))
    subprocess.run([installed("iasl"), "-p", folder / "gpio", HERE / "gpio.asl"],
                   stdout=subprocess.DEVNULL, check=True)  # fmt: skip


def add_content_options(parser):
    parser.add_argument("--program", action="append", default=[], type=Path)
    parser.add_argument("--folder", action="append", default=[], metavar="PATH=SOURCE",
                        type=lambda text: tuple(text.split("=", 1)))  # fmt: skip
    parser.add_argument("--cache", type=Path, default=CACHE)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("output", type=Path)
    add_content_options(parser)
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    build(options.output, options.program, options.folder, options.cache)


if __name__ == "__main__":
    sys.exit(main())
