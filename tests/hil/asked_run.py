"""What holds of each daemon that clients asked something of."""

from machine import summary


class AskedRun:
    """Beside unittest.TestCase."""

    @classmethod
    def folder_of_results(cls):
        raise NotImplementedError

    @classmethod
    def setUpClass(cls):
        cls.folder = cls.folder_of_results()
        cls.said = (cls.folder / "tactusd.txt").read_text()
        cls.run_summary = summary(cls.folder)
        cls.loop = cls.run_summary["loop"]
        print(f"{cls.loop['cycles']} cycles, {cls.loop['missed_cycles']} missed")

    def test_no_cycle_is_missed(self):
        self.assertEqual(self.loop["missed_cycles"], 0)
        self.assertEqual(self.loop["page_faults"], 0)

    def test_the_arm_goes_on(self):
        self.assertEqual(self.run_summary["outcome"], "completed")
        self.assertNotIn("fault", self.said)

    def test_replays_to_the_bit(self):
        self.assertIn("to the bit", (self.folder / "replay.txt").read_text())
