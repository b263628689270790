"""Files that nobody finds half written."""

import os


def write_whole(path, text):
    """All of it or nothing, whoever reads and whatever comes between, unless it is no file, as a pipe. Raises
    OSError."""
    whole = path.resolve()  # of a link the file that it leads to
    beside = whole.with_name(whole.name + ".new") if whole.is_file() or not whole.exists() else whole
    try:
        with open(beside, "w", encoding="utf-8", errors="surrogateescape", newline="") as file:
            file.write(text)
            file.flush()
            if beside != whole:
                os.fsync(file.fileno())
        if beside != whole:
            os.replace(beside, whole)
    except OSError:
        if beside != whole:
            beside.unlink(missing_ok=True)
        raise
