#!/usr/bin/python3
"""Runs one guest script, guest/TEST.sh, where there is CAN: on this machine, if the script may run
there ("# layers: host vm") and the kernel grants vcan and SCHED_FIFO, else in a virtual machine
with virtual time. Says which; neither is a failure.

usage: run.py TEST --out FOLDER [--layer host|vm] [the options of vm.py]

A script finds programs in PATH, folders as $ROOT/PATH, itself in $ROOT/guest, writes its results
to $ROOT/out, and has the layer in $LAYER. On the host it has network interfaces of its own."""

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import vm
from build_image import HERE, add_content_options


def _own_network():
    """Interfaces made here are seen by nobody else and vanish with the last process."""
    return ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--map-root-user", "--net"]


def host_lacks():
    """Why this machine cannot be the layer; empty where it can."""
    for purpose, command in {
        "vcan": ["ip", "link", "add", "probe", "type", "vcan"],
        "SCHED_FIFO": ["chrt", "-f", "80", "true"],
    }.items():
        done = subprocess.run(_own_network() + command, capture_output=True, check=False)
        if done.returncode != 0:
            return purpose
    return ""


def run_on_host(test, out, programs, folders, timeout_s):
    vm.clear(out)
    with tempfile.TemporaryDirectory() as scratch:
        root = Path(scratch)
        (root / "guest").symlink_to(HERE / "guest")
        (root / "out").symlink_to(out.resolve())
        (root / "bin").mkdir()
        for program in programs:
            (root / "bin" / program.name).symlink_to(program.resolve())
        for path, source in folders:
            (root / path.strip("/")).symlink_to(Path(source).resolve())
        environment = {"PATH": f"{root}/bin:/usr/sbin:/usr/bin:/sbin:/bin", "HOME": scratch,
                       "ROOT": scratch, "LAYER": "host"}  # fmt: skip
        with open(out / "console.txt", "wb") as console:
            done = subprocess.run(
                _own_network() + ["timeout", "-k", "5", str(timeout_s), "sh",
                                  f"{scratch}/guest/{test}.sh"],
                env=environment, cwd=scratch, stdin=subprocess.DEVNULL, stdout=console,
                stderr=subprocess.STDOUT, check=False)  # fmt: skip
    return done.returncode


def choose(test, wanted):
    """The layer, and why."""
    first_lines = vm.guest_script(test).read_text().split("\n")[:5]
    if wanted:
        return wanted, "as asked for"
    if "# layers: host vm" not in first_lines:
        return "vm", "needs GPIO or virtual time"
    lacks = host_lacks()
    return ("vm", f"this machine grants no {lacks}") if lacks else ("host", platform.release())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("test")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--layer", choices=["host", "vm"])
    parser.add_argument("--shift", type=int, default=0)
    parser.add_argument("--timeout", type=float, default=600)
    add_content_options(parser)
    options = parser.parse_args()
    content = (options.program, options.folder)
    start = time.monotonic()
    try:
        layer, reason = choose(options.test, options.layer)
        print(f"hil {options.test}: layer {layer} ({reason})", flush=True)
        if layer == "host":
            status = run_on_host(options.test, options.out, *content, options.timeout)
        else:
            status = vm.run(options.test, options.out, *content, options.shift, options.timeout,
                            options.cache)  # fmt: skip
    except RuntimeError as failure:
        print(f"hil {options.test}: {failure}", file=sys.stderr)
        status = vm.MACHINE_FAILED
    vm.print_console(options.out)
    print(f"hil {options.test}: status {status} after {time.monotonic() - start:.0f} s")
    return status


if __name__ == "__main__":
    sys.exit(main())
