"""How far a sweep has come, on standard error: one line that changes on a terminal, else a line now and then."""

import contextlib
import math
import sys
import time

ON_TERMINAL_S, IN_FILE_S = 0.2, 60.0
SILENT_S = 2.0


def progress_text(done, total, done_now, elapsed_s):
    """`done_now` of them in the last elapsed_s."""
    text = f"{done} of {total} runs, {100 * done // total} %"
    if done_now == 0 or elapsed_s < SILENT_S:
        return text
    left_s = elapsed_s * (total - done) / done_now
    return text + (f", {math.ceil(left_s)} s left" if left_s < 90 else f", {math.ceil(left_s / 60)} min left")


class Progress:
    def __init__(self, done, total):
        self.before, self.total = done, total
        self.begin = self.shown = time.monotonic()
        self.is_terminal = sys.stderr.isatty()

    def show(self, done):
        now = time.monotonic()
        if now - self.shown < (ON_TERMINAL_S if self.is_terminal else IN_FILE_S):
            return
        self.shown = now
        text = progress_text(done, self.total, done - self.before, now - self.begin)
        self.write(f"\r{text}\x1b[K" if self.is_terminal else text + "\n")

    def end(self):
        if self.is_terminal:
            self.write("\r\x1b[K")

    def write(self, text):
        """A terminal that has gone is no reason to stop."""
        with contextlib.suppress(OSError):
            print(text, end="", file=sys.stderr, flush=True)
