#!/usr/bin/python3
"""Faults injected while the arm moves in contact: how long until setpoints are zero and drives are
off, and whether it restarts in the documented way alone. Frames on the buses are the evidence.

usage: faults_test.py --tactus FILE --tactusd FILE --program FORBIDDEN_CALL_CHECK --out FOLDER
"""

import sys
import unittest
from dataclasses import dataclass

import candump_log
from candump_log import (
    NMT_PRE_OPERATIONAL,
    NMT_RESET_COMMUNICATION,
    NMT_RESET_NODE,
    NMT_STOP,
    SYNC,
)
from fault_case import CYCLE_US, FaultCase
from machine import Build

DRIVES = 9
HEARTBEAT_LOST, SYNC_LOST = 0x8130, 0x8700
POWER_RETURNS_US = 1_000_000


@dataclass(frozen=True)
class Expected:
    """Limits are cycles from the fault to zero setpoints, to a quick stop, to all drives off, to
    closed brakes; None: does not come to that."""

    mode: str
    fault: str
    reaction: str
    zero: int
    quick_stop: int | None = None
    off: int | None = None
    brake: int | None = None
    lost: tuple = ()  # buses and drives out of reach
    faulty: tuple = ()  # drives that stop by themselves, maybe before they are told
    restarts: bool = True


# Drives need some 115 ms for their own quick stop, with the ramp that they have from the plant.
QUICK_STOP_LASTS = 130
# The setpoint is zero at once; drives lag behind it, and the brake takes switching_s, 0.1 s, to hold.
RAMP_LASTS = 150
RETREAT_LASTS = 600
DEADLINE = 500  # can.stop_deadline_s
MOVES_ON = 100  # two windows in which a drive has to slow down
EXPECTED = {
    "e_stop": Expected("fault", "emergency_stop", "quick stop and brake", 2, 2, QUICK_STOP_LASTS, 2),
    "enable_off": Expected("holding", "", "", 5),
    "sigterm": Expected("stopping", "", "", 5, None, RAMP_LASTS, 5, restarts=False),
    "forbidden_call": Expected("stopping", "forbidden_system_call", "ramp", 4, None, RAMP_LASTS,
                               restarts=False),
    # The kernel empties the queue first and lets some cycles pass until it says that it is down; which
    # of both is seen first is a matter of the moment.
    "interface_down": Expected("fault", "bus_(stalled|down)", "quick stop", 6, 6, QUICK_STOP_LASTS,
                               QUICK_STOP_LASTS, lost=("can1",)),
    # Feedback is missing for more than five cycles.
    "node_reset": Expected("fault", "drive_silent", "quick stop", 8, 8, 8 + QUICK_STOP_LASTS,
                           8 + QUICK_STOP_LASTS, lost=(("can0", 2),)),
    "drive_silent": Expected("fault", "drive_silent", "quick stop", 7, 7, 7 + QUICK_STOP_LASTS,
                             7 + QUICK_STOP_LASTS),
    "overrun": Expected("stopping", "overrun", "ramp", 6, None, RAMP_LASTS, 6),
    "bus_off": Expected("fault", "bus_off", "quick stop", 3, 3, QUICK_STOP_LASTS, QUICK_STOP_LASTS,
                        lost=("can2",)),
    "drive_fault": Expected("fault", "drive_fault", "quick stop", 2, 2, QUICK_STOP_LASTS,
                            QUICK_STOP_LASTS, faulty=(("can0", 2),)),
    # max_sample_age_s: 20 ms; then the way out, without readings: 0.1 m at most and at 0.25 m/s.
    "tactile_stale": Expected("retreating", "tactile_stale", "retreat", 26 + RETREAT_LASTS),
    # Sixteen attempts without acknowledgement, and the controller is error-passive.
    "power_cut": Expected("fault", "bus_unacknowledged", "quick stop", 5, 5, QUICK_STOP_LASTS,
                          QUICK_STOP_LASTS, lost=("can1",)),
    "boot_up": Expected("fault", "drive_state_lost", "quick stop", 2, 2, QUICK_STOP_LASTS,
                        QUICK_STOP_LASTS, lost=(("can0", 2),)),
    # The one that moves on is not seen off. Nor are the next two, whatever their truth is.
    "ignore_commands": Expected("fault", "drive_fault", "quick stop", 2, 2, QUICK_STOP_LASTS,
                                MOVES_ON + 5, lost=(("can2", 2),), faulty=(("can0", 2),)),
    # Told with the next SYNC only, up to a cycle later, and read in the cycle after that.
    "nonsense_status": Expected("fault", "drive_state_lost", "quick stop", 3, 3, QUICK_STOP_LASTS,
                                DEADLINE + 5, lost=(("can1", 3),)),
    "freeze_feedback": Expected("fault", "emergency_stop", "quick stop and brake", 2, 2,
                                QUICK_STOP_LASTS, 2, lost=(("can0", 2),)),
    "never_off": Expected("stopping", "", "", 5, None, RAMP_LASTS, 5, lost=(("can1", 3),),
                          restarts=False),
}  # fmt: skip

# One drive is told to let go while it moves: by another's reset, or by the daemon where it says that it
# boots, or is not seen off by the deadline.
LETS_GO = {"node_reset", "boot_up", "never_off"}


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cases = {name: FaultCase(results / name, expected.lost, expected.faulty)
                     for name, expected in EXPECTED.items()}  # fmt: skip
        print("\n".join([TITLE, *map(row, cls.cases.values())]))

    def test_each_fault(self):
        checks = [self.was_moving, self.is_named, self.is_in_time, self.stays_at_rest,
                  self.restarts_only_if_asked_to, self.ends_at_rest]  # fmt: skip
        for name, expected in EXPECTED.items():
            for check in checks:
                with self.subTest(name, check=check.__name__):
                    check(self.cases[name], expected)

    def was_moving(self, case, _):
        self.assertEqual(len(case.commands), DRIVES)
        for node, own in case.commands.items():
            before = [c for c in own if c.t_us < case.fault_us][-5:]
            words = {c.control_word for c in before}
            self.assertEqual(words, {candump_log.ENABLE_OPERATION}, node)
        speeds = [abs(own[-1].velocity) for own in self._before_fault(case)]
        self.assertGreaterEqual(sum(speed > 0 for speed in speeds), 5)

    def _before_fault(self, case):
        return [[c for c in own if c.t_us < case.fault_us] for own in case.commands.values()]

    def is_named(self, case, expected):
        after = case.messages.split("tactusd: running\n", 1)[1]
        self.assertRegex(after, f"^tactusd: {expected.mode}")
        if expected.fault:
            self.assertRegex(after.split("\n")[0], f": {expected.fault}.*: {expected.reaction}$")

    def is_in_time(self, case, expected):
        measured = {"zero": case.zero_us(), "quick_stop": case.quick_stop_us(),
                    "off": case.off_us(), "brake": case.brake_us()}  # fmt: skip
        for what, time_us in measured.items():
            limit = getattr(expected, what)
            if limit is None:
                self.assertIsNone(time_us, what)
            else:
                self.assertIsNotNone(time_us, what)
                self.assertLessEqual(time_us, limit * CYCLE_US, what)

    def stays_at_rest(self, case, expected):
        from_us = case.fault_us + expected.zero * CYCLE_US
        # Until it was zero: a stop on a ramp or a hold leaves the drives enabled meanwhile.
        if expected.off and not expected.quick_stop:
            from_us = case.fault_us + expected.off * CYCLE_US
        late = case.forbidden_commands(from_us, may_hold=expected.off is None)
        self.assertEqual(late, [])
        self.assertEqual(case.plant["stale_setpoints_applied"], 0)
        self.assertEqual(case.plant["powers_taken_in_motion"], 1 if case.name in LETS_GO else 0)

    def restarts_only_if_asked_to(self, case, expected):
        for node, own in case.commands.items():
            moves = any(c.velocity != 0 for c in own if c.t_us > case.restart_us)
            self.assertEqual(moves, expected.restarts, node)

    def ends_at_rest(self, case, expected):
        for node, own in case.commands.items():
            self.assertEqual(own[-1].velocity, 0, node)
        for node, own in case.statuses.items():
            is_never_seen_off = not expected.restarts and node in expected.lost
            self.assertEqual(own[-1].is_off, not is_never_seen_off, node)

    def test_brakes_were_open(self):
        for name, expected in EXPECTED.items():
            marks = (results / name / "marks.txt").read_text()
            if expected.brake is not None:
                self.assertRegex(marks, r"(?m)^brake_before .* out=1 driven=1$", name)
                self.assertRegex(marks, r"(?m)^brake .* out=0 driven=1$", name)

    def test_nothing_waits_for_power_to_return(self):
        """From a cut bus on, no setpoint goes to it; the drives come back before the restart."""
        case = self.cases["power_cut"]
        cut_us = case.fault_us + EXPECTED["power_cut"].zero * CYCLE_US
        return_us = case.fault_us + POWER_RETURNS_US
        for node, own in case.commands.items():
            if node[0] == "can1":
                self.assertEqual([c for c in own if cut_us < c.t_us < return_us], [])
        frames = case.until_restart(case.frames)
        for node in (1, 2, 3):
            boots = candump_log.boot_ups(frames, ("can1", node))
            self.assertEqual(len(boots), 1)
            self.assertGreater(boots[0], return_us)

    def test_second_daemon_says_why_it_refuses(self):
        text = (results / "enable_off" / "second.txt").read_text()
        self.assertIn("another tactusd already runs", text)

    def test_forbidden_call_is_named(self):
        text = (results / "forbidden_call" / "stdout.txt").read_text()
        self.assertIn(" 1 forbidden calls, first: getpid\n", text)


@dataclass(frozen=True)
class Suspect:
    """A drive that is not seen off, and when its master loses patience with it."""

    node: tuple
    cut_off: int  # that many cycles after the fault
    moves_on: bool = False


SUSPECTS = {
    "ignore_commands": Suspect(("can2", 2), MOVES_ON, moves_on=True),
    "nonsense_status": Suspect(("can1", 3), DEADLINE),
    "freeze_feedback": Suspect(("can0", 2), DEADLINE),
}
NMT_STOP_LASTS = 20


class NotSeenOff(unittest.TestCase):
    """Drives that lie or do not obey are stopped by NMT, then by silence on their bus."""

    def test_each_suspect(self):
        for name, suspect in SUSPECTS.items():
            case = FaultCase(results / name)
            told = candump_log.nmt(case.until_restart(case.frames), suspect.node)
            stops_us = [t for t, command in told if command == NMT_STOP]
            for check in [self.is_told_to_stop, self.loses_its_bus, self.stands_still]:
                with self.subTest(name, check=check.__name__):
                    check(case, suspect, stops_us)

    def is_told_to_stop(self, case, suspect, stops_us):
        self.assertEqual(len(stops_us), 4)
        cut_off_us = stops_us[0] - case.fault_us
        # Feedback of the cycle before may come with the first.
        self.assertGreaterEqual(cut_off_us, (suspect.cut_off - 1) * CYCLE_US)
        self.assertLessEqual(cut_off_us, (suspect.cut_off + 5) * CYCLE_US)
        own = case.until_restart(case.commands[suspect.node])
        self.assertEqual([c for c in own if c.t_us > stops_us[0]], [])

    def loses_its_bus(self, case, suspect, stops_us):
        silent_us = stops_us[0] + NMT_STOP_LASTS * CYCLE_US
        bus, number = suspect.node
        sent = case.until_restart(candump_log.of_master(case.frames, bus))
        question = [bytes([NMT_PRE_OPERATIONAL, number]), bytes.fromhex("4064600000000000")]
        self.assertEqual([f.data for f in sent if f.t_us > silent_us], question)
        for other in {"can0", "can1", "can2"} - {bus}:
            sent = case.until_restart(candump_log.of_master(case.frames, other))
            syncs = [f for f in sent if f.id == SYNC and f.t_us > silent_us]
            self.assertGreater(len(syncs), 100)

    def stands_still(self, case, suspect, stops_us):
        ((asked_us, place),) = candump_log.asked_positions(case.frames)[suspect.node]
        told = candump_log.positions(case.frames)[suspect.node]
        again_us, again = next(p for p in told if p[0] > case.restart_us)
        self.assertGreater(again_us - asked_us, 100 * CYCLE_US)
        self.assertEqual(place, again)
        if suspect.moves_on:  # until it was told by NMT
            before = [position for t, position in told if t < case.fault_us][-1]
            last = [position for t, position in told if t < stops_us[0]][-1]
            self.assertGreater(abs(last - before), 20_000)  # 20 mrad
            self.assertLess(abs(place - last), 5_000)

    def test_keeps_its_watch_at_the_end(self):
        suspect = ("can1", 3)
        case = FaultCase(results / "never_off")
        for node in case.commands:
            told = [command for _, command in candump_log.nmt(case.frames, node)]
            last = [NMT_RESET_COMMUNICATION]
            if node == suspect:  # and asked twice
                last = [NMT_RESET_NODE, NMT_PRE_OPERATIONAL, NMT_PRE_OPERATIONAL]
            self.assertEqual([command for command in told if command != NMT_STOP], last, node)
        (_, place), (_, again) = candump_log.asked_positions(case.frames)[suspect]
        self.assertEqual(place, again)


class Restarted(unittest.TestCase):
    def test_who_says_that_it_boots_is_made_to(self):
        """It may run on, so all it said before it has booted once more is worth nothing."""
        node = ("can0", 2)
        case = FaultCase(results / "boot_up")
        frames = [f for f in case.frames if case.fault_us - CYCLE_US < f.t_us < case.restart_us]
        claim_us, boot_us = candump_log.boot_ups(frames, node)
        ((reset_us, command),) = candump_log.nmt(frames, node)
        self.assertEqual(command, NMT_RESET_NODE)
        self.assertLess(claim_us, reset_us)
        self.assertLess(reset_us - claim_us, 2 * CYCLE_US)
        self.assertLess(reset_us, boot_us)
        late = [c for c in case.until_restart(case.commands[node]) if c.t_us > reset_us]
        self.assertEqual(late, [])


class Killed(unittest.TestCase):
    """Nobody is left to stop the drives but themselves."""

    def test_drives_stop_by_their_own_watch(self):
        case = FaultCase(results / "sigkill")
        codes = candump_log.emergencies(case.frames)
        positions = candump_log.positions(case.frames)
        self.assertEqual(len(positions), DRIVES)
        stops_us = []
        for node, own in positions.items():
            t_us, code = next(emergency for emergency in codes[node]
                              if emergency[0] > case.fault_us)  # fmt: skip
            self.assertIn(code, (HEARTBEAT_LOST, SYNC_LOST))
            stops_us.append(t_us - case.fault_us)
            after = [position for t, position in own if t > case.fault_us + 150 * CYCLE_US]
            self.assertGreaterEqual(len(after), 2, node)
            self.assertEqual(len(set(after)), 1, node)
        for node, own in case.statuses.items():
            self.assertTrue(own[-1].is_off, node)
        print(f"{'sigkill':16}drives stop by themselves, from cycle {max(stops_us) / CYCLE_US:.1f} on")  # fmt: skip


TITLE = (f"{'injected':16}{'fault':24}{'reaction':22}{'zero':>8}{'quick stop':>12}{'off':>8}"
         f"{'brake':>8}   cycles after the fault")  # fmt: skip


def row(case):
    def cycles(time_us):
        return "-" if time_us is None else f"{time_us / CYCLE_US:.1f}"

    expected = EXPECTED[case.name]
    return (f"{case.name:16}{expected.fault or expected.mode:24}{expected.reaction:22}"
            f"{cycles(case.zero_us()):>8}{cycles(case.quick_stop_us()):>12}"
            f"{cycles(case.off_us()):>8}{cycles(case.brake_us()):>8}")  # fmt: skip


if __name__ == "__main__":
    build = Build()
    results = build.run("faults")
    unittest.main(argv=sys.argv[:1])
