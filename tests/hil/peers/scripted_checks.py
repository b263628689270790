"""The peers themselves: what the scripted master commanded, the drives did."""
import json
import unittest

from results import Run, check_drives, check_motion


class ScriptedMaster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = Run("scripted")
        cls.master = json.loads((cls.run_.folder / "master.json").read_text())

    def test_drives_were_enabled_and_disabled_once(self):
        check_drives(self, self.run_, ["switch on disabled"])

    def test_positions_are_the_integral_of_the_targets(self):
        check_motion(self, self.run_, self.master["period_s"])

    def test_drives_are_where_the_master_thinks(self):
        was_on_time = self.run_.was_on_time and self.master["missed_cycles"] == 0
        for commanded, moved in zip(self.master["commanded"], self.master["moved"]):
            allowed = 1 if was_on_time else 0.1 * abs(commanded)
            self.assertLessEqual(abs(commanded - moved), allowed)
            self.assertGreater(abs(moved), 1000)
