"""The panel's page in headless chromium, as its users see and use it."""
import re

from panel_rig import wait_for
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By


def make_browser():
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for option in ("headless=new", "no-sandbox", "disable-gpu", "disable-dev-shm-usage", "window-size=1200,900"):
        options.add_argument(f"--{option}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


class Page:
    """What a user sees and does."""

    def __init__(self, address):
        self.browser = make_browser()
        self.address = address

    def open(self):
        self.browser.get("about:blank")  # another fragment alone would load nothing
        self.browser.get(self.address)
        return self.await_life()

    def await_life(self):
        wait_for("a page that is alive", lambda: self.text("mode") == "running" and self.rows())
        return self

    def reload(self):
        self.browser.refresh()
        return self.await_life()

    def at(self, name):
        return self.browser.find_element(By.ID, name)

    def text(self, name):
        return self.at(name).text

    def rows(self):
        return self.browser.find_elements(By.CSS_SELECTOR, "#gains tr[data-key]")

    def input(self, key):
        return self.at(f"gain-{key}")

    def runs(self, key):
        return self.browser.find_element(By.CSS_SELECTOR, f'[data-key="{key}"] td:nth-child(2)').text

    def gain_state(self):
        return self.at("gain-state").get_attribute("data-state")

    def may_set(self):
        return self.at("set").is_enabled()

    def type(self, key, text):
        field = self.input(key)
        field.clear()
        field.send_keys(text)

    def set(self, key, text):
        self.type(key, text)
        wait_for("the margin", self.may_set)
        self.at("set").click()

    def contacts(self):
        return self.browser.execute_script(
            "return [...document.querySelectorAll('#contacts tbody tr')].map("
            "(row) => [...row.cells].map((cell) => cell.textContent))")

    def problems(self):
        """Errors of the console, as of a script or of the page's policy."""
        return [entry["message"] for entry in self.browser.get_log("browser")
                if not re.search("/api/(events|do) - Failed to load", entry["message"])]
