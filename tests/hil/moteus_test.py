#!/usr/bin/python3
"""The daemon with moteus controllers, on a vcan that carries CAN FD: as simulated, with frames as mjbots
has them, and refused on a bus without FD.

usage: moteus_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
"""

import re
import sys
import unittest

from machine import Build, summary

NAME = "planar2_moteus"
# A controller's answer tells of the cycle before, which is a millisecond that simulate does not have. The
# force comes to rest below the threshold, where no law holds it: there the millisecond is more of it.
DEVIATIONS = {"peak_force_N": 0.02, "final_force_N": 0.1}
# candump's log of a frame: its identifier, of FD one digit of flags (1: bit-rate switch), its data.
LINE = re.compile(r"\([\d.]+\) can0 ([0-9A-F]+)#(?:#(\d))?([0-9A-F]*)$")
MODULE = {0x110, 0x111, 0x112, 0x113}
# Of mjbots' reference: a write of mode 10, NaN as position and a float as velocity, three queries; and
# its answer.
COMMAND = re.compile(r"01000A0E200000C07F[0-9A-F]{8}")
ANSWER = re.compile(r"2100[0-9A-F]{2}2E01[0-9A-F]{16}210F00")


class Moteus(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = results / NAME
        cls.run_ = summary(cls.folder)

    def test_a_bus_without_fd_is_refused(self):
        said = (self.folder / "refused.txt").read_text()
        self.assertEqual(said.count("\n"), 1)
        self.assertIn("can0", said)
        self.assertIn("mtu 72", said)

    def test_no_cycle_is_missed(self):
        loop = self.run_["loop"]
        self.assertEqual(self.run_["outcome"], "completed")
        self.assertEqual((loop["missed_cycles"], loop["page_faults"], loop["malformed_drive_frames"]), (0, 0, 0))
        for counter in ("refused", "held_back", "error_frames", "foreign"):
            self.assertEqual(loop["buses"][0][counter], 0, counter)
        self.assertIn("equal to the bit", build.call("replay", self.folder / "run.ulg"))

    def test_forces_are_those_simulated(self):
        simulated = build.simulate(f"robots/{NAME}")
        self.assertGreater(simulated["peak_force_N"], 1.0)
        for force, deviation in DEVIATIONS.items():
            self.assertAlmostEqual(self.run_[force] / simulated[force], 1.0, delta=deviation, msg=force)

    def test_each_controller_is_asked_and_answers_in_each_cycle(self):
        asked, answered, others = {0x8001: 0, 0x8002: 0}, {0x100: 0, 0x200: 0}, set()
        said = set()
        for line in (self.folder / "candump.log").read_text().splitlines():
            name, flags, data = LINE.fullmatch(line).groups()
            frame = int(name, 16)
            said.update(kind for kind, bytes_ in (("command", COMMAND), ("answer", ANSWER))
                        if bytes_.match(data) and flags)
            if flags is None or not int(flags, 16) & 1:
                others.add(frame)
                continue
            (asked if frame in asked else answered)[frame] += 1
        print(f"asked {asked}, answered {answered}")
        self.assertEqual(others, MODULE)
        self.assertEqual(said, {"command", "answer"})
        self.assertGreaterEqual(min(*asked.values(), *answered.values()), self.run_["loop"]["cycles"] - 1)


if __name__ == "__main__":
    build = Build()
    results = build.run("moteus")
    unittest.main(argv=sys.argv[:1])
