#!/usr/bin/env python3
"""The examples for systemd-networkd set up every CAN interface that a robot of config names."""
import configparser
import fnmatch
import pathlib
import re
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
NETWORKD = ROOT / "config/networkd"


def interfaces():
    """Of all robots."""
    found = set()
    for file in (ROOT / "config/robots").rglob("*.yaml"):
        robot = yaml.safe_load(file.read_text(encoding="utf-8"))
        found |= {bus["interface"] for bus in robot.get("can", {}).get("buses", [])}
    return sorted(found)


def value(file, section, key):
    parser = configparser.ConfigParser()
    parser.optionxform = str
    parser.read(NETWORKD / file, encoding="utf-8")
    return parser[section][key]


class Networkd(unittest.TestCase):
    def test_has_each_interface_of_a_robot(self):
        names = interfaces()
        self.assertIn("can4", names, "config/robots/crops9_skin has five buses")
        for name in names:
            self.assertTrue(fnmatch.fnmatch(name, value("40-can.network", "Match", "Name")), name)
            self.assertTrue(fnmatch.fnmatch(f"v{name}", value("40-vcan.network", "Match", "Name")), name)
            self.assertEqual(value(f"40-v{name}.netdev", "NetDev", "Name"), f"v{name}")
            self.assertEqual(value(f"40-v{name}.netdev", "NetDev", "Kind"), "vcan")

    def test_the_queue_is_set_before_udev_names_adapters_on_usb(self):
        """The first .link that fits is all that an interface gets; and one of the user's own is to be it."""
        (link,) = NETWORKD.glob("*.link")
        self.assertTrue("20-" < link.name < "73-usb-net-by-mac.link", link.name)

    def test_and_the_way_back_removes_them_all(self):
        made = {value(file.name, "NetDev", "Name") for file in NETWORKD.glob("*.netdev")}
        text = (ROOT / "debian/tactusd.README.Debian").read_text(encoding="utf-8")
        loop = re.search(r"for i in ([\d ]+); do ip link del vcan\$i; done", text)
        self.assertEqual({f"vcan{i}" for i in loop.group(1).split()}, made)


if __name__ == "__main__":
    unittest.main()
