#!/usr/bin/env python3
"""docs/campaign.md from the results of the exhaustive campaign.

outcome_table.py RESULTS COUNT > docs/campaign.md: COUNT is how many cases there are."""
import collections
import sys

MODES = ["boot", "ready", "enabling", "running", "retreating", "holding", "stopping", "fault"]
HEAD = """# What every trouble comes to

Written by `tools/campaign --all` from its runs in virtual time: the daemon's cycle against the plant's
drives and module on buses of bit time, scene `scenario1_null_space` with e-stop line, enable line and brake.
It may be stopped and started again, and goes on where it was; all cases take some 20 minutes of one
core. A test (`python.campaign_table`) repeats a sample of these runs and compares it with this page.

**{ran} of {count} cases** were run for this page, in mixed order; a row that is missing has had none of them.
{verdict}

Each run goes on after what the tables show: when the arm should be at rest the user switches the enable line off
and on, the arm runs for 0.7 s if it may, and is stopped. Judges look at every cycle of all that
(`tests/campaign/judges.h`): setpoints within limits, zero where nothing may move, brakes closed, drives without
torque, none told to let go in motion before its brake holds (but for one that says that it boots, or moves on
though it was told to stop), no start without the line, nothing faster than undisturbed when the arm goes on. *Comes
to* is where it stands when the user comes, with the fault that is latched and its reaction; several, with how many
runs, where it depends on the phase, the joint or the bus. *Rest* is the longest time from where the arm left *running* (or, of a
trouble before it ran, the trouble's beginning) to where no drive moves any more; a retreat may take 1.5 s of it.
"""
MODE_HEAD = """
## Each trouble in each mode

Each lasts 0.3 s, or for good where it is one that does not end. It comes at 20 phases of each mode: the loop is
discrete, so a phase is a number of cycles after the mode's beginning. Ten are the cycle of the beginning and the
nine after it, so that every phase of the module's samples and of a drive's answers is among them; five
are spread over the mode's duration, at most 0.3 s; five of these fifteen come again with all frames of a bus in the
reverse order of arrival.

| Trouble | In mode | Comes to | Rest | Violated |
|---|---|---|---|---|
"""
PAIR_HEAD = """
## Pairs

All ordered pairs of troubles in *running*, the second 2 ms and 60 ms after the first: within the time in which the
first is seen, and while the arm stops. A row is what the first comes to with any second one.

| First | Comes to | Rest | Violated |
|---|---|---|---|
"""
FRAME_HEAD = """
## Each frame

Every single frame of three short runs (set-up to running; 60 ms in contact; 30 ms in which a drive fails) lost,
doubled, late by a cycle, or with one bit flipped, as no CAN bus lets it pass but a gateway may make it. Bits
take turns from frame to frame.

A drive of the plant takes any setpoint at once, within the limit of speed that the set-up told it (object 607F).
Without that limit a flipped bit sent a joint off at up to 256 rad/s, from which a quick stop takes longer than the
time it is given. CAN's checksum finds such a frame; one that it let pass, or a forged one, a drive believes.

| Run | Stream | Frame is | Comes to | Rest | Violated |
|---|---|---|---|---|---|
"""


def read(lines):
    """(words of the name, what it came to, ms to rest, violation) of each whole line."""
    cases = []
    for line in lines:
        cells = line.rstrip("\n").split("\t")
        if len(cells) != 8 or not line.endswith("\n"):
            continue
        name, mode, fault, reaction, rest_ms, _, _, violation = cells
        came_to = mode if fault == "none" else f"{mode} ({fault}, {reaction})"
        cases.append((name.split(), came_to, int(rest_ms), violation))
    return cases


class Row:
    def __init__(self):
        self.came_to = collections.Counter()
        self.rest_ms = 0
        self.violations = collections.Counter()

    def add(self, came_to, rest_ms, violation):
        self.came_to[came_to] += 1
        self.rest_ms = max(self.rest_ms, rest_ms)
        if violation != "-":
            self.violations[violation] += 1

    def cells(self):
        endings = sorted(self.came_to.items(), key=lambda one: (-one[1], one[0]))
        text = "; ".join(f"{name}: {count}" if len(endings) > 1 else name for name, count in endings)
        violated = "; ".join(f"{name}: {count}" for name, count in sorted(self.violations.items()))
        return f"{text} | {self.rest_ms} ms | {violated}"


def key_of(words):
    """The row that a case belongs to."""
    if words[0] == "mode":
        return "mode", words[1], words[2]
    if words[0] == "pair":
        return "pair", words[1]
    return "frame", words[1], words[2], words[3]


def rows_of(cases):
    rows = collections.defaultdict(Row)
    for words, came_to, rest_ms, violation in cases:
        rows[key_of(words)].add(came_to, rest_ms, violation)
    return rows


def order_of(key):
    return [MODES.index(word) if word in MODES and i == 2 and key[0] == "mode" else word
            for i, word in enumerate(key)]


def page(cases, count):
    rows = rows_of(cases)
    bad = sum(violation != "-" for *_, violation in cases)
    verdict = f"In {bad} of them something was violated." if bad else "Nothing was violated."
    text = HEAD.format(ran=len(cases), count=count, verdict=verdict)
    for group, head in (("mode", MODE_HEAD), ("pair", PAIR_HEAD), ("frame", FRAME_HEAD)):
        text += head
        for key in sorted((key for key in rows if key[0] == group), key=order_of):
            text += f"| {' | '.join(key[1:])} | {rows[key].cells()} |\n".replace("|  |", "| |")
    return text


def parse(text):
    """Of the page: {key: (set of endings, ms to rest, violation)}."""
    found, group = {}, None
    heads = {"## Each trouble in each mode": ("mode", 2), "## Pairs": ("pair", 1),
             "## Each frame": ("frame", 3)}
    for line in text.splitlines():
        group = heads.get(line, group)
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if not group or not line.startswith("| ") or not cells[-2].endswith(" ms"):
            continue
        name, size = group
        endings = {ending.rsplit(":", 1)[0] for ending in cells[size].split("; ")}
        found[(name, *cells[:size])] = (endings, int(cells[-2].split()[0]), cells[-1])
    return found


if __name__ == "__main__":
    with open(sys.argv[1]) as results:
        sys.stdout.write(page(read(results), int(sys.argv[2])))
