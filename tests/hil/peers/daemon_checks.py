"""The daemon among third-party peers: what it logged is what was on the buses and what they did."""
import unittest

import cantools
import numpy
from pyulog import ULog

from results import REPOSITORY, Run, check_drives, check_motion
from slow_scene import PERIOD_S, SLOW_BUS, SlowScene

JOINTS = 9
MASTER_ID = 127
COLUMNS = [
    "t_s", "force_sensor_N", "contact_position_m", "contact_dir_x", "contact_dir_y", "contact_dir_z",
    "force_contact_N", "stiffness_N_per_m", "stiffness_raw_N_per_m", "gamma", "k_n", "k_j", "k_t",
    "x_dot_eff_m_per_s", "u_n", "u_j", "u_t",
    *(f"q[{i}]" for i in range(JOINTS)), *(f"dq[{i}]" for i in range(JOINTS)),
    *(f"{name}[{i}]" for name in ("w", "wd", "wd_dot") for i in range(3)),
    "fault", "wake_latency_ns", "step_ns",
]  # fmt: skip


class Daemon(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = Run("daemon")
        cls.scene = SlowScene(cls.run_.folder)
        cls.log = ULog(str(cls.run_.folder / "slow/run.ulg"))
        cls.cycles = cls.log.get_dataset("cycle").data
        cls.frames = cls.run_.frames()
        cls.database = cantools.database.load_file(REPOSITORY / "config/can/tactus.dbc")

    def joint_column(self, name, joint):
        return self.cycles[f"{name}[{joint}]"]

    def drive_of(self, joint):
        wanted = self.scene.drives[joint]
        key = (wanted["interface"], wanted["node_id"])
        return next(d for d in self.run_.drives if (d["bus"], d["node_id"]) == key)

    def signal(self, joint, message, name):
        """All values of a drive's signal, decoded as the DBC file says."""
        drive = self.scene.drives[joint]
        frame_id = self.database.get_message_by_name(f"{message}_{drive['node_id']}").frame_id
        key = (drive["interface"], frame_id)
        own = [f for f in self.frames if (f.channel, f.arbitration_id) == key]
        return numpy.array([self.database.decode_message(frame_id, f.data)[name] for f in own])

    def test_drives_were_enabled_and_disabled_once(self):
        check_drives(self, self.run_, ["switched on", "switch on disabled"])
        self.assertEqual([drive["resets"] for drive in self.run_.drives], [1] * JOINTS)

    def test_positions_are_the_integral_of_the_targets(self):
        check_motion(self, self.run_, PERIOD_S)

    def test_drives_know_period_and_heartbeats(self):
        for drive in self.run_.drives:
            period_s = drive["interpolation_value"] * 10.0 ** drive["interpolation_index"]
            self.assertAlmostEqual(period_s, PERIOD_S, 12)
            self.assertEqual(drive["producer_heartbeat"], 1000 * SLOW_BUS["heartbeat_period_s"])
            consumer = MASTER_ID << 16 | int(1000 * SLOW_BUS["heartbeat_timeout_s"])
            self.assertEqual(drive["consumer_heartbeat"], consumer)

    def test_log_opens_with_pyulog(self):
        self.assertFalse(self.log.file_corruption)
        self.assertEqual(self.log.dropouts, [])
        names = [field.field_name for field in self.log.get_dataset("cycle").field_data]
        self.assertEqual([name for name in names if name != "timestamp"][: len(COLUMNS)], COLUMNS)
        self.assertGreaterEqual(len(self.cycles["t_s"]), 10)
        self.assertGreaterEqual(self.cycles["t_s"][-1], 4.5)
        self.assertFalse(numpy.any(self.cycles["fault"]))
        self.assertTrue(all(numpy.all(numpy.isfinite(column)) for column in self.cycles.values()))

    def test_setpoints_on_the_bus_are_those_of_the_log(self):
        for joint in range(JOINTS):
            # The last cycle sends no setpoint, but lets the drives go.
            wanted = self.joint_column("dq", joint)[:-1] * self.scene.counts_per_unit(joint)
            sent = self.signal(joint, "RPDO1", "target_velocity")
            # Before and after the motion that is logged, zeros are sent.
            starts = range(len(sent) - len(wanted) + 1)
            best = min(numpy.max(numpy.abs(sent[s : s + len(wanted)] - wanted)) for s in starts)
            self.assertLessEqual(best, 1.0, f"joint {joint}")

    def test_drives_followed(self):
        farthest = 0.0
        for joint in range(JOINTS):
            q = self.joint_column("q", joint)
            reached = self.signal(joint, "TPDO1", "actual_position")[-1]
            fastest = numpy.max(numpy.abs(self.joint_column("dq", joint)))
            late = 10 * PERIOD_S * fastest * abs(self.scene.counts_per_unit(joint))
            allowed = 2 if self.run_.was_on_time else 2 + late
            self.assertLessEqual(abs(self.scene.counts(joint, q[-1]) - reached), allowed)
            self.assertEqual(reached, round(self.drive_of(joint)["position"]))
            farthest = max(farthest, numpy.ptp(q))
        self.assertGreater(farthest, 0.1)  # m or rad: else following would be no feat

    def test_dbc_describes_all_frames_and_no_others(self):
        seen = set()
        for frame in self.frames:
            message = self.database.get_message_by_frame_id(frame.arbitration_id)
            self.assertEqual(len(frame.data), message.length, frame)
            message.decode(frame.data)
            seen.add(message.name)
        expected = {message.name for message in self.database.messages}
        self.assertEqual(seen | {f"EMCY_{node_id}" for node_id in (1, 2, 3)}, expected)
