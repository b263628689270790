"""Programs that follow a file: how far they have read it, by what the kernel tells of their descriptors."""
import os
import pathlib
import time

PATIENCE_S = 60.0


def has_read(program, path):
    """Whether it has this file open, and is at its end."""
    try:
        links = list(pathlib.Path(f"/proc/{program.pid}/fd").iterdir())
    except OSError:  # it has ended
        return False
    for link in links:
        try:
            if not os.path.samefile(link, path):
                continue
            facts = pathlib.Path(f"/proc/{program.pid}/fdinfo/{link.name}").read_text().splitlines()
        except OSError:  # closed meanwhile
            continue
        if f"pos:\t{os.path.getsize(path)}" in facts:
            return True
    return False


def wait_until_read(program, path):
    end = time.monotonic() + PATIENCE_S
    while not has_read(program, path):
        if program.poll() is not None:
            raise AssertionError(f"{program.args} has ended")
        if time.monotonic() > end:
            raise AssertionError(f"{program.args} does not read {path} to its end")
        time.sleep(0.005)
