"""Studies that were changed by chance: read, or refused with one line that names the place. What reaches
code that nothing before it reached is changed further. TACTUS_STUDY_SECONDS: for a longer look than each
build's."""

import math
import os
import random
import re
import sys
import time
import unittest

from common import ROOT, Scratch
from sweep_common import STUDY  # which finds tactus_sweep
from tactus_sweep import study as studies
from tactus_sweep.study_text import StudyError

TRIES = 1500
DRAWN = 256  # runs: what is larger is counted only, for time
PACKAGE = str(ROOT / "tools/tactus_sweep")
SEEDS = [STUDY.replace(str(ROOT), "/r"), (ROOT / "config/studies/stiff_profile.yaml").read_text(encoding="utf-8"),
         "scenes: [a]\nsobol: {points: 8, keys: {a.b: {from: -1, to: 1}}}\nobjective: peak_force_N\n",
         "scenes: [a]\nsobol: {points: 2, keys: {a: {from: -1e308, to: 1e308}}}\n",
         "scenes: [a]\nsobol: {points: 2, keys: {a: {mean: 0, standard_deviation: 1e308}}}\n",
         "scenes: [a]\nsobol: {points: 2, keys: {a: {mean: 1, standard_deviation: 1e20, from: 0, to: 2}}}\n",
         "scenes: [a]\ngrid: {a: {from: 1, to: 4, count: 4, scale: log}}\nlimits: {peak_force_N: 1}\n"
         "objective: {peak_force_N: 1, tcp_error_max_m: 2}\n",
         "scenes: [a]\ngrid: {a: {from: 1, to: 10, count: 4, whole: true}}\n"]
WORDS = ["nan", ".inf", "-1e308", "1e308", "5e-324", "0", "-1", "1_000", "0x10", "999999999999999999", "٣",
         "1e", "true", "~", "''", "\"\\e[2J\"", "{}", "[]", "[[]]", "{a: b}", "- ", "? ", "|", ">", "&a ", "*a",
         "!!python/object:os.system ", "!!float ", "%YAML 1.1\n---\n", "---\n", "\t", "\x00", "\x1b[2J", "\ufeff",
         "\u2028", "# ", ": ", ", ", "=", ".", "[" * 2000, "from", "to", "count", "scale", "log", "linear",
         "whole", "mean", "standard_deviation", "points", "draws", "seed", "keys", "scenes", "set", "grid",
         "latin_hypercube", "sobol", "disturbances", "limits", "objective"]


class HostileStudies(Scratch):
    def test_are_read_or_refused_with_the_place(self):
        chance = random.Random(20)
        corpus = [seed.encode() for seed in SEEDS]
        reached, read, refused = set(), 0, 0
        path = self.folder / "study.yaml"
        for tried in tries():
            text = changed(chance, corpus) if tried >= len(SEEDS) else corpus[tried]
            before = len(reached)
            path.write_bytes(text)
            try:
                with Lines(reached):
                    self.look(path)
                read += 1
            except StudyError as error:
                refused += 1
                self.assertRegex(str(error), rf"\A{re.escape(str(path))}:\d+:\d+: [^\n]+, expected [^\n]+\Z", text)
                self.assertTrue(str(error).isprintable(), text)
            except Exception:
                print(f"study: {text!r}", file=sys.stderr)
                raise
            if len(reached) > before:
                corpus.append(text)
        print(f"{read} read, {refused} refused, {len(reached)} lines, {len(corpus)} kept")
        self.assertGreater(min(read, refused), 20)

    def look(self, path):
        study = studies.read_study(path)
        files = [[(name, "")] for _, name, _ in study.scenes]
        if 0 < runs_of(study) <= DRAWN or runs_of(study) > studies.MAX_RUNS:
            plan = studies.make_plan(study, files)
            self.assertEqual(plan.runs, runs_of(study))
            for run in (0, plan.runs - 1):
                self.check(study, plan.settings(run))

    def check(self, study, settings):
        values = dict(setting.split("=", 1) for setting in settings)
        self.assertEqual(len(values), len(study.fixed) + len(study.axes))
        for axis in study.axes:
            if axis.texts:
                self.assertIn(values[axis.key], axis.texts)
            else:
                self.assertTrue(axis.lower <= float(values[axis.key]) <= axis.upper, values)
                low, high = (float(axis.at(u).split("=")[1]) for u in (0.0, 0.7))
                self.assertTrue(axis.lower <= low <= high <= axis.upper, axis)
                self.assertTrue(all(math.isfinite(axis.value(u)) for u in (0.0, 0.3, 0.7)), axis)
                self.assertTrue(axis.value(0.3) < axis.value(0.7) or axis.is_whole, axis)


def tries():
    seconds = float(os.environ.get("TACTUS_STUDY_SECONDS", 0.0))
    end = time.monotonic() + seconds
    tried = 0
    while tried < TRIES or time.monotonic() < end:
        yield tried
        tried += 1


def runs_of(study):
    count = len(study.scenes) * study.points.count * study.disturbances.count
    for axis in study.grid:
        count *= len(axis.texts)
    return count


def changed(chance, corpus):
    text = chance.choice(corpus)
    for _ in range(chance.choice((1, 1, 2, 4))):
        at, to = sorted(chance.randrange(len(text) + 1) for _ in range(2))
        short = text[at:min(to, at + chance.choice((1, 4, 16)))]
        text = chance.choice((
            lambda: text[:at] + chance.choice(WORDS).encode("utf-8") + text[at + len(short):],
            lambda: text[:at] + chance.choice(WORDS).encode("utf-8") + text[at:],
            lambda: text[:at] + text[at + len(short):],
            lambda: text[:at] + bytes([chance.randrange(256)]) + text[at + 1:],
            lambda: text[:at] + text[at:to] + text[at:],
            lambda: with_other_line(chance, text, chance.choice(corpus)),
        ))()
    return text[:1 << 16]


def with_other_line(chance, text, other):
    lines = text.split(b"\n")
    lines[chance.randrange(len(lines))] = chance.choice(other.split(b"\n"))
    return b"\n".join(lines)


class Lines:
    """Adds the lines of the package that run to a set."""

    def __init__(self, reached):
        self.reached = reached

    def __enter__(self):
        self.before = sys.gettrace()
        sys.settrace(self.call)

    def __exit__(self, *_):
        sys.settrace(self.before)

    def call(self, frame, *_):
        return self.line if frame.f_code.co_filename.startswith(PACKAGE) else None

    def line(self, frame, *_):
        self.reached.add((frame.f_code.co_filename, frame.f_lineno))
        return self.line


if __name__ == "__main__":
    unittest.main(verbosity=2)
