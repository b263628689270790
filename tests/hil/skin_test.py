#!/usr/bin/python3
"""An arm with three tactile modules on two buses, on the daemon, over vcan, in virtual time: as simulated,
and with one of them unplugged.

usage: skin_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]"""

import unittest

from machine import Build, summary

SCENE = "crops9_skin_two_links"
UNPLUGGED_S, LOST_WITHIN_S = 1.2, 0.04
DEVIATION = 0.035  # of forces, as in scenes_test.py where the stiffness is estimated
SPEED_SHARE = 0.25


class Skin(unittest.TestCase):
    def check_loop(self, run):
        loop = run["loop"]
        for counter in ["missed_cycles", "dropped_records", "page_faults"]:
            self.assertEqual(loop[counter], 0, counter)
        self.assertEqual(len(loop["tactile_modules"]), 3)

    def check_replay(self, name):
        self.assertIn("equal to the bit", build.call("replay", results / name / "run.ulg"))

    def last_row(self, name, mode=None):
        """Of this mode, or of any."""
        csv = build.out / f"{name}.csv"
        build.call("export", results / name / "run.ulg", "-o", csv)
        with open(csv, encoding="utf-8") as lines:
            names = next(lines).strip().split(",")
            rows = [dict(zip(names, line.strip().split(","))) for line in lines]
        return [row for row in rows if mode is None or row["mode_name"] == mode][-1]

    def check_rest(self, name, link):
        run = summary(results / name)
        self.check_loop(run)
        self.assertEqual(run["outcome"], "tactile_stale")
        self.assertEqual(run["fault"]["tactile_module"], link)
        self.assertGreaterEqual(run["fault"]["time_s"], UNPLUGGED_S - 0.2)
        row = self.last_row(name)
        for joint in range(1, 10):
            self.assertEqual(float(row[f"dq_{joint}"]), 0.0, "the arm is at rest")
        self.check_replay(name)

    def test_stops(self):
        self.check_rest("stops", "link6")
        self.check_rest("stops_untouched", "link3")

    def test_stops_in_contact_where_it_may_go_on(self):
        self.check_rest("slow_in_contact", "link6")
        self.assertEqual(summary(results / "slow_in_contact")["module_losses"], [])

    def test_goes_on_slowly(self):
        run = summary(results / "goes_on_slowly")
        self.check_loop(run)
        self.assertEqual(run["outcome"], "completed")
        self.assertEqual([loss["tactile_module"] for loss in run["module_losses"]], ["link3"])
        row = self.last_row("goes_on_slowly", "running")
        self.assertEqual(float(row["speed_share"]), SPEED_SHARE)
        self.assertEqual(row["modules_lost"], "1")
        slow_s = float(row["t_s"]) - run["module_losses"][0]["start_s"]
        late_s = float(row["task_time_s"]) - float(row["path_time_s"])
        self.assertAlmostEqual(late_s, (1.0 - SPEED_SHARE) * slow_s, delta=0.1)
        said = (results / "goes_on_slowly" / "tactusd.txt").read_text()
        self.assertIn("tactile module link3 lost at ", said)
        self.check_replay("goes_on_slowly")

    def test_scene_as_simulated(self):
        daemon, simulated = summary(results / SCENE), build.simulate(f"whole_arm/{SCENE}")
        self.check_loop(daemon)
        self.assertEqual(daemon["outcome"], "completed")
        for force in ["peak_force_N", "final_force_N"]:
            self.assertAlmostEqual(daemon[force] / simulated[force], 1.0, delta=DEVIATION, msg=force)
        self.assertEqual({contact["tactile_module"] for contact in daemon["contacts"]},
                         {"link4", "link6"})
        self.check_replay(SCENE)


if __name__ == "__main__":
    build = Build()
    results = build.run("skin")
    unittest.main(argv=["skin_test.py"])
