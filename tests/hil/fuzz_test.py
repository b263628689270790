#!/usr/bin/python3
"""The daemon while somebody sends random frames by all ids that it listens to: it runs on or comes to
rest with a named fault, and no setpoint ever leaves the limits.

usage: fuzz_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

import re
import sys
import unittest
from collections import Counter

import candump_log
from machine import REPOSITORY, Build, summary

# The robot's limits: those of its URDF and of guest/daemon.sh.
MAX_SPEED, MAX_ACCELERATION, PERIOD_S = 5.0, 200.0, 0.001  # m or rad, and s
ROUNDING = 2  # counts per second
MODE = re.compile(r"tactusd: (boot|ready|enabling|running|retreating|holding|stopping|fault|off)(?:: (\w+).*)?")


class Fuzz(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = results / "in_contact"
        cls.commands = candump_log.commands(candump_log.read(cls.folder / "candump.log"))
        cls.modes = MODE.findall((cls.folder / "tactusd.txt").read_text())
        print(f"modes: {dict(Counter(mode for mode, _ in cls.modes))}")
        print(f"faults: {dict(Counter(fault for _, fault in cls.modes if fault))}")

    def test_frames_were_heard(self):
        self.assertGreaterEqual(len({fault for _, fault in self.modes if fault}), 3)
        loop = summary(self.folder)["loop"]
        self.assertGreater(loop["malformed_drive_frames"], 100)
        self.assertGreater(loop["tactile"]["malformed"], 10)

    def test_every_line_is_a_mode_with_a_fault_of_the_table(self):
        names = fault_names()
        lines = (self.folder / "tactusd.txt").read_text().splitlines()
        remedies = [line for line in lines if line.startswith("tactusd: what to do: ")]
        self.assertLessEqual(len(remedies), len([fault for _, fault in self.modes if fault]))
        self.assertEqual(lines[0], "tactusd: waits until the enable line was off and is on")
        self.assertEqual(len(self.modes), len(lines) - 1 - len(remedies))
        for mode, fault in self.modes:
            self.assertIn(fault, names | {""})
            if mode == "fault":
                self.assertTrue(fault)

    def test_setpoints_stay_within_limits(self):
        self.assertEqual(len(self.commands), 9)
        for node, own in self.commands.items():
            counts = counts_per_unit(node)
            fastest = max(abs(command.velocity) for command in own)
            self.assertGreater(fastest, 0, node)
            self.assertLessEqual(fastest, MAX_SPEED * counts + ROUNDING, node)

    def test_only_stops_are_harder_than_the_acceleration_limit(self):
        for node, own in self.commands.items():
            step = MAX_ACCELERATION * PERIOD_S * counts_per_unit(node) + ROUNDING
            for before, after in zip(own, own[1:]):
                if after.velocity != 0:
                    self.assertLessEqual(abs(after.velocity - before.velocity), step, (node, after))

    def test_nothing_moves_without_the_command_to_enable(self):
        for node, own in self.commands.items():
            wrong = [c for c in own if c.velocity != 0
                     and c.control_word != candump_log.ENABLE_OPERATION]  # fmt: skip
            self.assertEqual(wrong, [], node)

    def test_it_ends_at_rest(self):
        self.assertEqual([mode for mode, _ in self.modes][-3:], ["running", "stopping", "off"])
        for node, own in self.commands.items():
            self.assertEqual(own[-1].velocity, 0, node)
        self.assertEqual(summary(self.folder)["loop"]["missed_cycles"], 0)


def fault_names():
    source = (REPOSITORY / "src" / "control" / "fault.cpp").read_text()
    return set(re.findall(r'\{k\w+, "(\w+)"', source))


def counts_per_unit(node):
    return 1e7 if node == ("can0", 1) else 1e6


if __name__ == "__main__":
    build = Build()
    results = build.run("fuzz")
    unittest.main(argv=sys.argv[:1])
