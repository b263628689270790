#!/usr/bin/env python3
"""The table of hazards in docs/safety.md: each row is whole, its tests exist, and each fault has one.
The check itself must be able to fail.

usage: hazards_test.py MODE_MODEL
"""
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())


def known_tests():
    """By their sources: under the sanitizers a program is one test of ctest."""
    names = set()
    for path in (ROOT / "tests").glob("*/*_test.cpp"):
        names |= {".".join(match) for match in
                  re.findall(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", path.read_text(), re.M)}
    cmake = (ROOT / "tests/CMakeLists.txt").read_text()
    names |= set(re.findall(r"^ *(?:add_test\(NAME|tactus_python_test\() ?([\w.]+)", cmake, re.M))
    return names | {f"hil.{name}" for name in re.findall(r"^ *tactus_hil_test\((\w+)", cmake, re.M)}


def known_faults():
    manual = subprocess.run([PROGRAM, "faults.8"], check=True, capture_output=True, text=True).stdout
    return set(re.findall(r"^\.B (\w+)$", manual, re.M))


def problems(page, tests, faults):
    section = page[page.index("\n## Hazards\n"):]
    rows = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            for line in re.search(r"\n\|---.*\n((?:\|.*\n)+)", section).group(1).splitlines()]
    found = []
    seen = set()
    for row in rows:
        _, cause, detection, reaction, _, remains, event, named = row if len(row) == 8 else [""] * 8
        if not all([cause, detection, reaction, remains, event, named]) or not rows[0][0]:
            found.append(f"not whole: {row}")
        seen |= set(re.findall(r"^`(\w+)` \(\d+\)$", event))
        found += [f"no such test: {name}" for name in named.replace("`", "").split(", ")
                  if name not in tests]
    return found + [f"no row: {fault}" for fault in sorted(faults - seen)]


class HazardsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page = (ROOT / "docs/safety.md").read_text()
        cls.tests, cls.faults = known_tests(), known_faults()

    def problems(self, page):
        return problems(page, self.tests, self.faults)

    def test_each_row_is_whole_and_tested_and_each_fault_has_one(self):
        self.assertGreater(len(self.tests), 1000)
        self.assertGreater(len(self.faults), 20)
        self.assertEqual(self.problems(self.page), [])

    def test_a_row_without_its_test_is_refused(self):
        page = self.page.replace("`LyingDrive.ThatMovesOnIsBrakedAndStoppedInTime`", "`Lying.Drive`")
        self.assertEqual(self.problems(page), ["no such test: Lying.Drive"])
        page = self.page.replace("`hil.faults`", "`hil.nothing`")
        self.assertIn("no such test: hil.nothing", self.problems(page))
        self.assertEqual(self.problems(re.sub(r"`InterfaceLock[^|]*\|", "|", self.page))[1:],
                         ["no such test: "])

    def test_a_fault_without_a_row_is_refused(self):
        page = re.sub(r"^.*`gpio_lost` \(19\).*\n", "", self.page, flags=re.M)
        self.assertEqual(self.problems(page), ["no row: gpio_lost"])


if __name__ == "__main__":
    unittest.main()
