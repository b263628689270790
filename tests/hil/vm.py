#!/usr/bin/python3
"""Runs one guest script, guest/TEST.sh, in a virtual machine with virtual time: one instruction
takes 2^shift ns, so that two runs are equal to the bit, however busy the host is.

usage: vm.py TEST [--out FOLDER] [--program FILE]... [--folder PATH=SOURCE]... [--shift N]
             [--timeout SECONDS] [--cache FOLDER]

What the script writes to /out lands in FOLDER, with the console's output as console.txt. Exits with
the script's status, or 125 where the machine did not get so far."""

import argparse
import io
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

from build_image import HERE, add_content_options, build, installed

SHARED_MIB = 256  # for results; the file is sparse
PAGE = 4096
MACHINE_FAILED = 125


class MachineFailed(RuntimeError):
    """The script's status is not known."""


def _command(folder, test, shift):
    # The kernel's tests of its own ciphers take half of its start. RCU callbacks keep a socket waiting
    # for up to 2 ms unless a thread of their own runs them, as nohz_full has it on a robot's machine.
    options = ("console=ttyS0 quiet panic=-1 cryptomgr.notests rcu_nocbs=0 iomem=relaxed "
               f"memmap=64K$0x20000000 test={test}")  # fmt: skip
    return [
        "setpriv", "--pdeathsig", "KILL",  # whoever kills this script kills the machine
        installed("qemu-system-x86_64"), "-M", "pc", "-cpu", "max", "-m", "1024", "-smp", "1",
        "-accel", "tcg", "-icount", f"shift={shift},sleep=off", "-seed", "42",
        "-rtc", "base=2025-01-01T00:00:00,clock=vm",
        "-nodefaults", "-no-reboot", "-display", "none", "-monitor", "none",
        "-kernel", folder / "vmlinux", "-initrd", folder / "initrd", "-append", options,
        "-acpitable", f"file={folder}/gpio.aml",
        "-serial", f"file:{folder}/console", "-serial", "null",
        "-object", f"memory-backend-file,id=shared,share=on,size={SHARED_MIB}M,"
                   f"mem-path={folder}/shared",
        "-device", "ivshmem-plain,memdev=shared,addr=0x10",
    ]  # fmt: skip


def _handed_over(path):
    """What guest/hand_over.c left: the script's status and the files of /out as a tar archive."""
    with open(path, "rb") as shared:
        header = shared.read(PAGE).partition(b"\n")[0].split()
        if len(header) != 3 or header[0] != b"tactus-hil":
            raise MachineFailed("the machine ended without handing over a result")
        return int(header[1]), shared.read(int(header[2]))


def guest_script(test):
    script = HERE / "guest" / f"{test}.sh"
    if not script.exists():
        raise RuntimeError(f"there is no {script}")
    return script


def clear(out):
    """Results of an earlier run must not pass for this one's."""
    if out.exists() and any(out.iterdir()):
        if not (out / "console.txt").exists():
            raise RuntimeError(f"{out} holds files, but no console.txt: not a folder of results")
        shutil.rmtree(out)
    out.mkdir(parents=True, exist_ok=True)


def print_console(out):
    if (out / "console.txt").exists():
        sys.stdout.write((out / "console.txt").read_text(errors="replace"))


def run(test, out, programs=(), folders=(), shift=0, timeout_s=600, cache=None):
    """Returns the script's exit status. Raises MachineFailed; the console's output is in
    out/console.txt even then."""
    guest_script(test)
    cache.mkdir(parents=True, exist_ok=True)
    clear(out)
    with tempfile.TemporaryDirectory(prefix="run-", dir=cache) as scratch:
        folder = Path(scratch)
        build(folder, programs, folders, cache)
        try:
            subprocess.run(_command(folder, test, shift), stdin=subprocess.DEVNULL,
                           timeout=timeout_s, check=True)  # fmt: skip
            status, archive = _handed_over(folder / "shared")
        except subprocess.TimeoutExpired as late:
            raise MachineFailed(f"the machine did not end within {timeout_s} s") from late
        except subprocess.CalledProcessError as failed:
            raise MachineFailed(f"QEMU exits with {failed.returncode}") from failed
        finally:
            if (folder / "console").exists():
                (out / "console.txt").write_bytes((folder / "console").read_bytes())
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:
        files.extractall(out)
    return status


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("test")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--shift", type=int, default=0)
    parser.add_argument("--timeout", type=float, default=600)
    add_content_options(parser)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as unnamed:
        out = options.out or Path(unnamed)
        try:
            status = run(options.test, out, options.program, options.folder, options.shift,
                         options.timeout, options.cache)  # fmt: skip
        except RuntimeError as failure:
            print(f"vm: {failure}", file=sys.stderr)
            status = MACHINE_FAILED
        print_console(out)
    return status


if __name__ == "__main__":
    sys.exit(main())
