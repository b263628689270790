#!/usr/bin/python3
"""The daemon whose gains are changed while the arm moves in contact, beside the panel, scope, stream and
list of contacts, and whom others send what is no request: no cycle is missed, the run replays to the
bit, gains included, and all that look on see what the log has.

usage: control_test.py --tactus FILE --tactusd FILE --out FOLDER [--keep]
           [--program TACTUS_PANEL --folder DYGRAPHS=DYGRAPHS]
"""

import json
import sys
import unittest

from asked_run import AskedRun
from machine import Build


class Control(AskedRun, unittest.TestCase):
    @classmethod
    def folder_of_results(cls):
        return results / "control"

    def test_the_journal_names_the_changes(self):
        self.assertIn("tactusd: gains: change 1 ramping\n", self.said)
        self.assertIn("tactusd: gains: change 1 on_trial\n", self.said)


def lines(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


class Watchers(unittest.TestCase):
    """Each beside the daemon, in contact."""

    @classmethod
    def setUpClass(cls):
        cls.folder = results / "control/watching"
        cls.log = results / "control/run.ulg"

    def test_contacts_are_those_of_the_whole_log(self):
        whole = json.loads(build.call("contacts", self.log, "--json"))
        self.assertGreater(len(whole), 0)
        self.assertEqual(lines(self.folder / "contacts.jsonl"), whole)

    def test_scope_shows_what_it_does_of_the_whole_log(self):
        whole = json.loads(build.call("scope", self.log, "--post", "1", "--json"))
        self.assertGreater(len(whole), 0)
        self.assertEqual(lines(self.folder / "scope.jsonl"), whole)

    def test_stream_has_the_contact(self):
        sent = lines(self.folder / "stream.jsonl")
        times = [cycle["timestamp"] for cycle in sent]
        self.assertEqual(times, sorted(times))
        self.assertGreater(len(set(times)), 5)
        self.assertTrue(any(cycle.get("force_sensor_N", 0) > 1.2 for cycle in sent))


class Panel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not any(program.name == "tactus-panel" for program in build.programs):
            raise unittest.SkipTest("built without the panel")
        cls.folder = results / "control/watching"

    def answer(self, name):
        return json.loads((self.folder / name).read_text())

    def shown(self, name):
        """The first event, of all that there is."""
        first = (self.folder / name).read_text().split("\n")[0]
        return json.loads(first.removeprefix("data: "))

    def test_serves_its_page(self):
        self.assertIn("<title>", (self.folder / "index.html").read_text())
        self.assertIn("controller.damping", [key["key"] for key in self.answer("keys.json")])

    def test_sees_the_daemon_and_the_contact(self):
        before = self.shown("before.txt")
        state = before["state"]
        self.assertTrue(state["is_there"])
        self.assertEqual(state["problem"] + state["control_problem"] + state["log_problem"], "")
        self.assertEqual(state["status"]["mode"], "running")
        self.assertEqual(state["gains"]["ordered"]["controller.damping"], 0.5)
        self.assertGreater(len(before["lasting"]), 0)
        self.assertGreater(max(before["force"]["high"][0]), 1.2)

    def test_knows_what_a_gain_would_do(self):
        check = self.answer("check.json")
        self.assertEqual(check["refused"], "")
        self.assertGreater(check["margin_deg"], 30)
        self.assertNotEqual(check["margin_deg"], check["running_deg"])

    def test_sets_a_gain_with_its_token_alone(self):
        change = {"controller.damping": {"from": 0.5, "to": 0.6}}
        self.assertEqual(self.answer("set.json")["changes"], change)
        gains = self.shown("after.txt")["state"]["gains"]
        self.assertEqual(gains["ordered"]["controller.damping"], 0.6)
        self.assertEqual(self.answer("set.json")["number"], gains["number"])
        self.assertEqual(self.answer("undo.json")["changes"]["controller.damping"]["to"], 0.5)


if __name__ == "__main__":
    build = Build()
    results = build.run("control")
    unittest.main(argv=sys.argv[:1])
