#!/usr/bin/env python3
"""The panel as its users meet it: stories in a browser, with a daemon and an arm in virtual time.

usage: panel_test.py TACTUS_PANEL VIRTUAL_DAEMON

SCREENSHOTS in the environment: a folder for pictures of the page.
"""
import contextlib
import os
import pathlib
import socket
import sys
import threading
import time
import unittest

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from panel_browser import Page  # noqa: E402
from panel_rig import POST, Rig, wait_for  # noqa: E402

DAEMON = pathlib.Path(sys.argv.pop(2)).resolve()
PANEL = pathlib.Path(sys.argv.pop(1)).resolve()
DAMPING, T = "controller.damping", "controller.time_constant_s"
# All texts that an element ever had.
WATCH = """const seen = [], at = document.querySelector(arguments[0]);
new MutationObserver(() => seen.push(at.textContent)).observe(at, {childList: true, subtree: true,
                                                                    characterData: true});
window.seen = seen;"""


class Tunnel:
    """As of ssh: who listens stays where what is behind it falls silent, and what was sent comes late."""

    def __init__(self, port):
        self.to, self.goes_on = port, threading.Event()
        self.goes_on.set()
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.port = self.listening.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        with contextlib.suppress(OSError):
            while True:
                near, _ = self.listening.accept()
                self.goes_on.wait()  # the other end connects once it hears of it
                far = socket.create_connection(("127.0.0.1", self.to))
                for source, sink in ((near, far), (far, near)):
                    threading.Thread(target=self.pass_on, args=(source, sink), daemon=True).start()

    def pass_on(self, source, sink):
        with contextlib.suppress(OSError), source:
            while piece := source.recv(65536):
                self.goes_on.wait()
                sink.sendall(piece)
            sink.shutdown(socket.SHUT_WR)


class Stories(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rig = Rig(PANEL, DAEMON)
        cls.addClassCleanup(cls.rig.close)
        cls.rig.start_daemon(POST, pace=3)
        cls.rig.start_panel()
        cls.page = Page(cls.rig.address)
        cls.addClassCleanup(cls.page.browser.quit)
        cls.page.open()
        cls.start_m = cls.rig.task()["p_BaseTool_m"]

    def setUp(self):
        self.page.reload()

    def tearDown(self):
        self.assertEqual(self.page.problems(), [])

    def touch(self):
        if not self.rig.task()["contact"]:
            self.assertEqual(self.rig.do({"do": "move", "relative": True, "to_m": [0, 0.35, 0]})[0], 200)
            wait_for("a contact", lambda: self.rig.task()["contact"])

    def leave(self):
        self.assertEqual(self.rig.do({"do": "move", "to_m": self.start_m})[0], 200)
        wait_for("no contact", lambda: not self.rig.task()["contact"])

    def gain(self, key):
        return self.rig.show()["ordered"][key]

    def test_01_sees_mode_and_force_live(self):
        self.touch()
        self.assertEqual(self.page.text("mode"), "running")
        self.assertIn("commands (null_limit)", self.page.text("scene"))
        self.assertIn("link4", self.page.text("forces"))
        wait_for("a force", lambda: float(self.page.text("forces").split()[1]) > 1.2)

        def newest():
            return self.page.browser.execute_script("return rows.length ? rows[rows.length - 1][0] : 0")
        before = newest()
        wait_for("the plot goes on", lambda: newest() > before + 1)
        self.leave()
        wait_for("no force", lambda: float(self.page.text("forces").split()[1]) < 1.2)

    def test_01_draws_the_forces_that_the_law_has(self):
        def limits(variant):
            return self.page.browser.execute_script(
                "return forceLimits(state.gains.ordered, arguments[0]).map((limit) => limit[0])", variant)
        self.assertEqual(limits("null_limit"), ["F_th", "F_act + F_th"])
        for variant in ("null_space", "joint_space", "none"):
            self.assertEqual(limits(variant), ["F_th"], variant)

    def test_02_sets_a_gain_and_sees_it_ramp_and_be_kept(self):
        self.touch()
        self.page.browser.execute_script(WATCH, f'[data-key="{T}"] td:nth-child(2)')
        self.page.type(T, "0.3")
        wait_for("the margin", self.page.may_set)
        self.assertRegex(self.page.text("margin"), r"Phase margin \d+\.\d° → \d+\.\d°, at least 30\.0°")
        self.assertEqual(self.page.text("verdict"), "Would be taken.")
        self.page.at("set").click()
        wait_for("kept", lambda: "is kept" in self.page.text("gain-state"))
        self.assertEqual(self.page.runs(T), "0.3 s")
        self.assertEqual(self.page.input(T).get_attribute("value"), "")
        on_its_way = [text for text in self.page.browser.execute_script("return window.seen") if "→ 0.3" in text]
        values = [float(text.split()[0]) for text in on_its_way]
        self.assertTrue([value for value in values if 0.1 < value < 0.3], on_its_way)
        self.assertEqual(values, sorted(values))
        self.rig.do({"do": "set", "values": {T: "0.1"}})
        wait_for("as before", lambda: self.rig.show()["state"] == "kept")

    def test_03_learns_why_a_gain_is_refused_before_it_is_sent(self):
        before = self.rig.show()["number"]
        for key, text, reason in ((T, "0.02", r"time_constant_s: .* expected at least 0\.\d+ s"),
                                  (DAMPING, "nonsense", "damping: .* expected a number"),
                                  ("controller.activation_force_N", "-1", "expected a number > 0")):
            self.page.type(key, text)
            wait_for("a verdict", lambda: self.page.text("verdict").startswith("Refused: "))
            self.assertRegex(self.page.text("verdict"), reason)
            self.assertFalse(self.page.may_set())
            self.page.input(key).send_keys(Keys.ENTER)
            self.page.input(key).send_keys(Keys.ESCAPE)
            wait_for("nothing is typed", lambda: self.page.text("verdict") == "")
        self.assertEqual(self.rig.show()["number"], before)

    def test_04_takes_a_change_back(self):
        before = self.gain(DAMPING)
        self.page.set(DAMPING, "0.62")
        wait_for("what was set", lambda: self.page.runs(DAMPING) == "0.62")
        self.page.at("undo").click()
        wait_for("as before", lambda: self.page.runs(DAMPING) == f"{before:g}")
        self.assertEqual(self.gain(DAMPING), before)

    def test_05_saves_to_the_scene_file(self):
        self.page.set(DAMPING, "0.57")
        wait_for("what was set", lambda: self.gain(DAMPING) == 0.57)
        self.assertNotIn("0.57", self.rig.scene.read_text())
        self.page.at("save").click()
        wait_for("written", lambda: "written" in self.page.text("message"))
        self.assertRegex(self.rig.scene.read_text(), r"(?m)^  damping: 0\.57$")
        self.page.at("save").click()
        wait_for("all that runs", lambda: "all that runs" in self.page.text("message"))

    def test_06_two_browsers_see_each_others_changes(self):
        other = Page(self.rig.address)
        self.addCleanup(other.browser.quit)
        other.open()
        self.page.set(DAMPING, "0.64")
        wait_for("what the first has set", lambda: other.runs(DAMPING) == "0.64")
        other.set(DAMPING, "0.66")
        wait_for("what the second has set", lambda: self.page.runs(DAMPING) == "0.66")

    def test_07_says_that_the_daemon_is_gone_and_goes_on_when_it_is_back(self):
        for is_killed in (False, True):
            self.rig.stop_daemon(is_killed)
            wait_for("a word", lambda: "goes on when there is one again" in self.page.text("banner"))
            self.assertEqual(self.page.text("mode"), "no daemon")
            self.assertFalse(self.page.at("undo").is_enabled())
            self.rig.start_daemon(POST, pace=3)
            wait_for("the new one", lambda: self.page.text("mode") == "running")
            wait_for("no word", lambda: not self.page.at("banner").is_displayed())
            self.assertTrue(self.page.at("undo").is_enabled())
        self.assertEqual(self.page.contacts(), [])

    def test_08_sees_a_contact_in_table_and_overlay(self):
        self.leave()
        before = [row for row in self.page.contacts() if "lasts" not in row]
        self.touch()
        wait_for("one that lasts", lambda: self.page.contacts() and "lasts" in self.page.contacts()[0])
        self.leave()
        wait_for("a row", lambda: len([row for row in self.page.contacts() if "lasts" not in row]) > len(before))
        start_s, link, _, peak_N = self.page.contacts()[0][1:5]
        self.assertEqual(link, "link4")
        # The overlay has that peak, at the touch.
        top = self.page.browser.execute_script(
            "let best = [0, 0]; for (let i = 0; i < plots.overlay.numRows(); ++i) "
            "if (plots.overlay.getValue(i, 1) > best[1]) "
            "best = [plots.overlay.getValue(i, 0), plots.overlay.getValue(i, 1)]; return best")  # fmt: skip
        self.assertAlmostEqual(top[1], float(peak_N), delta=0.006)
        self.assertTrue(0 <= top[0] < 0.5, top)
        self.assertGreater(float(start_s), 0)

    def test_09_moves_and_holds_the_tool(self):
        self.leave()
        for name, text in (("y", "0.02"), ("speed", "0.05")):
            self.page.at(name).clear()
            self.page.at(name).send_keys(text)
        self.page.at("relative").click()
        y_m = wait_for("rest", lambda: self.rig.task()["state"] == "arrived" and self.rig.task())["p_BaseTool_m"][1]
        self.page.at("move").click()
        wait_for("it was told", lambda: "On its way" in self.page.text("move-message"))
        wait_for("there", lambda: abs(self.rig.task()["p_BaseTool_m"][1] - y_m - 0.02) < 1e-4)
        wait_for("arrived", lambda: self.page.text("task-state").startswith("arrived"))
        self.page.at("y").clear()
        self.page.at("y").send_keys("9")
        self.page.at("move").click()
        wait_for("a refusal", lambda: "out of reach" in self.page.text("move-message"))
        self.rig.do({"do": "move", "relative": True, "to_m": [0, 0.1, 0], "speed_m_per_s": 0.01})
        wait_for("moving", lambda: self.page.text("task-state").startswith("moving"))
        self.page.at("hold").click()
        wait_for("holding", lambda: self.page.text("task-state").startswith("holding"))
        self.assertEqual(self.rig.task()["state"], "holding")

    def test_10_sets_a_gain_with_the_keyboard_alone(self):
        wanted = f"gain-{DAMPING}"
        for _ in range(60):
            self.page.browser.switch_to.active_element.send_keys(Keys.TAB)
            if self.page.browser.switch_to.active_element.get_attribute("id") == wanted:
                break
        focused = self.page.browser.switch_to.active_element
        self.assertEqual(focused.get_attribute("id"), wanted)
        self.assertNotEqual(focused.value_of_css_property("outline-style"), "none")
        focused.send_keys("0.59")
        wait_for("the margin", self.page.may_set)
        self.page.browser.switch_to.active_element.send_keys(Keys.ENTER)
        wait_for("set", lambda: self.gain(DAMPING) == 0.59)
        wait_for("seen", lambda: self.page.runs(DAMPING) == "0.59")

    def test_11_fits_screens_in_the_dark_and_in_the_light(self):
        self.touch()
        self.page.type(T, "0.02")
        wait_for("a verdict", lambda: self.page.text("verdict").startswith("Refused: "))
        grounds = set()
        for width, height in ((1200, 1500), (400, 2900)):
            for scheme in ("light", "dark"):
                self.page.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
                    "width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
                self.page.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
                    "features": [{"name": "prefers-color-scheme", "value": scheme}]})
                self.assert_fits(width)
                grounds.add(self.page.browser.find_element(By.TAG_NAME, "body").value_of_css_property("background-color"))
                if "SCREENSHOTS" in os.environ:
                    self.page.browser.save_screenshot(f"{os.environ['SCREENSHOTS']}/panel_{width}_{scheme}.png")
        self.assertEqual(len(grounds), 2)
        self.page.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})

    def assert_fits(self, width):
        """Nothing is wider than the screen, and no control is cut off or covered by another one."""
        def widest():
            return self.page.browser.execute_script("return document.documentElement.scrollWidth")
        wait_for("plots of the new width", lambda: widest() <= width)
        hidden = self.page.browser.execute_script("""
            return [...document.querySelectorAll("button, input, section")].filter((part) => {
              const box = part.getBoundingClientRect();
              return box.width > 0 && (box.left < 0 || box.right > innerWidth ||
                                       part.scrollWidth > part.clientWidth + 2 && part.matches("button"));
            }).map((part) => part.id || part.tagName);""")
        self.assertEqual(hidden, [])

    def test_12_reads_without_the_token_and_changes_nothing(self):
        self.page.browser.execute_script("sessionStorage.clear()")
        self.page.browser.get("about:blank")
        self.page.browser.get(self.rig.address.partition("#")[0])
        self.page.await_life()
        self.assertIn("Read only", self.page.text("banner"))
        self.assertFalse(self.page.at("to-posture").is_displayed(), "there is none")
        for name in ("set", "undo", "save", "hold", "move"):
            self.assertFalse(self.page.at(name).is_enabled(), name)
        # Only its address has the token, and not for long.
        self.page.open()
        self.assertNotIn(self.rig.token, self.page.browser.current_url)
        self.assertFalse(self.page.at("banner").is_displayed())

    def test_13_pages_behind_others_leave_them_the_connections(self):
        # A browser has six to a server; commands need one, too.
        first, others = self.open_others(7, "tab")
        self.page.at("hold").click()
        wait_for("holding", lambda: self.page.text("hold-message") == "Holding.")
        self.close_windows(others, first)
        wait_for("life", lambda: not self.page.at("banner").is_displayed())
        self.page.set(DAMPING, "0.61")
        wait_for("what was set", lambda: self.page.runs(DAMPING) == "0.61")

    def open_others(self, count, kind):
        """The page that was there, and those that show the same now."""
        browser, first = self.page.browser, self.page.browser.current_window_handle
        others = []
        for _ in range(count):
            browser.switch_to.new_window(kind)
            others.append(browser.current_window_handle)
            self.page.open()
        return first, others

    def close_windows(self, others, first):
        for other in others:
            self.page.browser.switch_to.window(other)
            self.page.browser.close()
        self.page.browser.switch_to.window(first)

    def test_13_six_windows_beside_each_other_hold_and_set(self):
        browser = self.page.browser
        first, others = self.open_others(5, "window")
        self.assertFalse(browser.execute_script("return document.hidden"))
        browser.switch_to.window(first)
        self.assertFalse(browser.execute_script("return document.hidden"), "all are seen")
        for window in (first, others[-1]):
            browser.switch_to.window(window)
            self.page.at("hold").click()
            wait_for("holding", lambda: self.page.text("hold-message") == "Holding.", patience_s=5)
            wait_for("events", lambda: not self.page.at("banner").is_displayed())
        self.page.set(DAMPING, "0.62" if self.gain(DAMPING) != 0.62 else "0.6")
        wait_for("sent", lambda: "sent" in self.page.text("message"), patience_s=10)
        self.close_windows(others, first)
        wait_for("kept", lambda: self.rig.show()["state"] == "kept")

    def behind_a_tunnel(self):
        tunnel = Tunnel(self.rig.port)
        self.addCleanup(tunnel.listening.close)
        page = Page(self.rig.address.replace(f":{self.rig.port}/", f":{tunnel.port}/"))
        self.addCleanup(page.browser.quit)
        return tunnel, page.open()

    def test_14_does_not_take_the_last_word_of_a_dead_connection_for_live(self):
        tunnel, page = self.behind_a_tunnel()
        tunnel.goes_on.clear()
        wait_for("a word", lambda: "does not answer" in page.text("banner"), patience_s=20)
        tunnel.goes_on.set()
        wait_for("no word", lambda: not page.at("banner").is_displayed(), patience_s=20)
        page.set(DAMPING, "0.63")
        wait_for("what was set", lambda: page.runs(DAMPING) == "0.63")

    def test_15_a_page_that_is_one_too_many_says_so_and_can_hold(self):
        self.page.browser.get("about:blank")
        streams = [wait_for("a place", self.rig.open_events) for _ in range(8)]
        draining = [threading.Thread(target=lambda events=events: list(events), daemon=True) for events in streams]
        for thread in draining:
            thread.start()
        self.page.browser.get(self.rig.address)
        wait_for("the reason", lambda: "8 pages are open already" in self.page.text("banner"))
        self.assertTrue(self.page.at("hold").is_enabled())
        self.page.at("hold").click()
        wait_for("holding", lambda: self.page.text("hold-message") == "Holding.")
        self.rig.stop_panel()
        self.rig.start_panel()
        for thread in draining:
            thread.join()
        self.page.address = self.rig.address
        self.page.open()

    def test_16_says_that_a_panel_that_began_anew_takes_no_changes_from_it(self):
        port = self.rig.port
        self.rig.stop_panel()
        wait_for("a word", lambda: "does not answer" in self.page.text("banner"))
        self.assertTrue(self.page.at("hold").is_displayed())
        self.rig.start_panel("--port", str(port))
        wait_for("a word", lambda: "Read only" in self.page.text("banner"))
        for name in ("set", "undo", "save", "hold", "move"):
            self.assertFalse(self.page.at(name).is_enabled(), name)
        self.assertTrue(self.page.at("hold").is_displayed())
        self.page.address = self.rig.address
        self.page.open()
        self.assertTrue(self.page.at("hold").is_enabled())

    def test_17_moves_nothing_that_comes_late_out_of_a_tunnel_but_holds(self):
        tunnel, page = self.behind_a_tunnel()
        page.at("y").send_keys("0.01")
        page.at("relative").click()
        before = self.rig.task()["number"]
        tunnel.goes_on.clear()
        page.at("move").click()
        time.sleep(6)
        tunnel.goes_on.set()
        wait_for("a refusal", lambda: "came late" in page.text("move-message"))
        self.assertEqual(self.rig.task()["number"], before)
        tunnel.goes_on.clear()
        page.at("hold").click()
        time.sleep(6)
        tunnel.goes_on.set()
        wait_for("holding", lambda: page.text("hold-message") == "Holding.")
        self.assertEqual(self.rig.task()["number"], before + 1)


class Led(unittest.TestCase):
    """An arm whose joints are led to a posture, which goes on while the tool holds."""

    def test_leads_the_arm_back(self):
        rig = Rig(PANEL, DAEMON)
        self.addCleanup(rig.close)
        rig.start_daemon("simulation.obstacles=[]", pace=5, scene=rig.folder / "config/scenes/home.yaml")
        rig.start_panel()
        page = Page(rig.address)
        self.addCleanup(page.browser.quit)
        page.open()
        self.assertEqual(rig.do({"do": "move", "relative": True, "to_m": [0, 0.2, 0]})[0], 200)
        wait_for("away", lambda: "from the posture" in page.text("task-state"))
        page.at("to-posture").click()
        wait_for("it was told", lambda: "On its way" in page.text("move-message"))
        wait_for("there", lambda: page.text("task-state").endswith("in the posture"))
        self.assertEqual(rig.task()["posture"]["is_there"], True)
        self.assertEqual(page.problems(), [])


if __name__ == "__main__":
    unittest.main()
