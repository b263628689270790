#!/usr/bin/env python3
"""The manual pages: groff has nothing to say against them, their options are those of the programs,
and those of the files hold every key.

usage: manual_test.py TACTUS TACTUSD
"""
import json
import pathlib
import re
import subprocess
import sys
import unittest

TACTUSD = pathlib.Path(sys.argv.pop(2)).resolve()
TACTUS = pathlib.Path(sys.argv.pop(1)).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[2]
OPTION = re.compile(r"(?<![\w/-])(--?[A-Za-z][\w-]*)")
ON_ALL_COMMANDS = {"-h", "--help"}


def output(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


def page_text(name):
    return (ROOT / "docs/man" / name).read_text()


def pages():
    texts = {path.name: path.read_text() for path in sorted((ROOT / "docs/man").iterdir())}
    for name in ("scene", "robot"):
        texts[f"tactus-{name}.5"] = output(TACTUS, "keys", "--man", name)
    return texts


def groff(text, *options):
    return subprocess.run(["groff", "-man", "-Tutf8", *options], input=text, capture_output=True,
                          text=True, timeout=60)


def rendered(text):
    """As it is read, without its breaks: no bold, no hyphenation."""
    plain = groff(text, "-rHY=0", "-rLL=2000n", "-P-cbou").stdout
    plain = re.sub("[\u2010\u2212]", "-", plain)
    return re.sub(r"\s+", " ", plain.replace("\u2019", "'"))


def options_of_help(text):
    """The first words of the lines that list options."""
    listed = re.findall(r"^\s+(-[^\n]*?)(?:\s{2,}|$)", text, re.M)
    return {option for line in listed for option in OPTION.findall(line)}


def options_of_page(text):
    """The words of the tags that are options."""
    tags = re.findall(r"^\.TP\n(.*)$", text, re.M)
    words = (re.sub(r"\\f.|\\-|\"", lambda m: "-" if m[0] == r"\-" else "", tag) for tag in tags)
    return {option for tag in words for option in OPTION.findall(tag)}


class Pages(unittest.TestCase):
    def test_are_clean(self):
        self.assertEqual(len(pages()), 5)
        for name, text in pages().items():
            result = groff(text, "-ww", "-z")
            self.assertEqual((result.returncode, result.stderr), (0, ""), name)
            self.assertTrue(text.isascii(), name)

    def test_can_be_unclean(self):
        self.assertNotEqual(groff(".TH X 1\n.TP\n\\*[nothing]\n.nonsense\n", "-ww", "-z").stderr, "")

    def test_refer_to_pages_that_exist(self):
        titles = {name for name in pages()}
        for name, text in pages().items():
            for other, section in re.findall(r"^\.BR (tactus[\w\\-]*) \((\d)\)", text, re.M):
                self.assertIn(f"{other.replace(chr(92), '')}.{section}", titles, name)

    def test_hold_every_key(self):
        texts = {name: rendered(output(TACTUS, "keys", "--man", name)) for name in ("scene", "robot")}
        rows = json.loads(output(TACTUS, "keys", "--json"))
        self.assertGreater(len(rows), 100)
        for row in rows:
            is_part = row["type"] == "section" and "." not in row["key"]
            self.assertIn(f" {row['key']} ", texts[row["file"]])
            self.assertIn(f"{': ' if is_part else ''}{row['meaning']}.", texts[row["file"]])


class Options(unittest.TestCase):
    def expect_equal(self, page, help_text, ignored=frozenset()):
        found = options_of_help(help_text) - ignored
        self.assertTrue(found, help_text)
        self.assertEqual(options_of_page(page), found)

    def test_commands_of_tactus(self):
        page = page_text("tactus.1")
        commands = page[page.index("\n.SH COMMANDS\n"):page.index("\n.SH EXIT STATUS\n")]
        parts = dict(re.findall(r"^\.SS (\w+)\n(.*?)(?=^\.SS |\Z)", commands, re.M | re.S))
        help_text = output(TACTUS, "--help")
        listed = re.findall(r"^  (\w+) ", help_text[help_text.index("Subcommands:"):], re.M)
        self.assertEqual(sorted(parts), sorted(listed))
        for name in listed:
            self.assertIn(f"\n\\fBtactus {name}\\fR", page, "SYNOPSIS")
            self.expect_equal(parts[name], output(TACTUS, name, "--help"), ON_ALL_COMMANDS)

    def test_tactusd(self):
        page = page_text("tactusd.8")
        options = page[page.index("\n.SH OPTIONS\n"):page.index("\n.SH MODES\n")]
        self.expect_equal(options, output(TACTUSD, "--help"))

    def test_report(self):
        self.expect_equal(page_text("tactus-report.1"), output(ROOT / "tools/report", "--help"))


unittest.main()
