#!/usr/bin/python3
"""Lives of the daemon on real vcan, GPIO and sockets, with what happens to one by chance: gains, targets,
streams, strangers, stops, an unplugged bus, a kill. It always goes on, misses no cycle, grows in nothing,
and what it wrote replays to the bit.

usage: soak_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep] [--hour]
"""

import collections
import json
import sys
import unittest

from machine import TIMEOUT_S, Build

Resources = collections.namedtuple("Resources", "life when resident_kB descriptors threads")
CLIENTS = 8  # at most, which the daemon may not know yet to have gone
GROWTH_KB = 2048  # a list of contacts, samples of one that lasts, pages of a stack


def resources():
    rows = [line.split() for line in (results / "soak/resources.txt").read_text().splitlines()]
    return [Resources(int(row[0]), row[1], *map(int, row[2:])) for row in rows]


class Soak(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rows = resources()
        paths = sorted((results / "soak").glob("summary.*.json"))
        cls.summaries = [json.loads(path.read_text()) for path in paths]
        cycles = sum(run["cycles"] for run in cls.summaries)
        missed = sum(run["loop"]["missed_cycles"] for run in cls.summaries)
        lives = cls.rows[-1].life
        actions = (results / "soak/actions.txt").read_text().split()
        seconds = float((results / "soak/uptime.txt").read_text().split()[0])
        print(f"{lives} lives, {len(actions)} actions, {seconds:.0f} s, {cycles} cycles in those that "
              f"{len(cls.summaries)} stop requests ended, {missed} missed")  # fmt: skip

    def test_no_cycle_is_missed(self):
        self.assertTrue(self.summaries)
        for run in self.summaries:
            self.assertEqual(run["loop"]["missed_cycles"], 0)
            self.assertEqual(run["loop"]["dropped_records"], 0)

    def test_every_life_replays(self):
        lines = (results / "soak/replay.txt").read_text().splitlines()
        self.assertEqual(len([line for line in lines if "to the bit" in line]), self.rows[-1].life)

    def test_nothing_grows(self):
        first = self.rows[0]
        for row in self.rows:
            with self.subTest(row):
                self.assertLessEqual(row.descriptors, first.descriptors + CLIENTS)
                self.assertEqual(row.threads, first.threads)
                self.assertLess(row.resident_kB, first.resident_kB + GROWTH_KB)

    def test_no_file_of_the_log_is_larger_than_allowed(self):
        sizes = [int(line.split()[0]) for line in (results / "soak/bytes.txt").read_text().splitlines()]
        self.assertGreater(len(sizes), self.rows[-1].life, "files never changed")
        self.assertLessEqual(max(sizes), 2000000)


if __name__ == "__main__":
    hour = "--hour" in sys.argv
    sys.argv = [word for word in sys.argv if word != "--hour"]
    build = Build()
    results = build.run("soak_hour", timeout_s=8 * TIMEOUT_S) if hour else build.run("soak")
    unittest.main(argv=sys.argv[:1])
