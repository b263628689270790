#!/usr/bin/env python3
"""docs/campaign.md says what a sample of its runs comes to. Arguments: tactus_campaign, and how many cases."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "campaign"))
import outcome_table  # noqa: E402

PROGRAM = sys.argv.pop(1)
CASES = sys.argv.pop(1)
OTHER_COMPILER_MS = 3  # a drive's last creeping hangs on rounding
PAGE = (ROOT / "docs" / "campaign.md").read_text()


def differences(cases, page):
    table = outcome_table.parse(page)
    for words, came_to, rest_ms, violation in cases:
        row = table.get(outcome_table.key_of(words))
        if row is None:
            yield f"{' '.join(words)}: no row"
        elif came_to not in row[0]:
            yield f"{' '.join(words)}: {came_to} instead of {' or '.join(sorted(row[0]))}"
        elif rest_ms > row[1] + OTHER_COMPILER_MS:
            yield f"{' '.join(words)}: rests after {rest_ms} ms, not {row[1]} ms"
        elif violation != "-" and not row[2]:
            yield f"{' '.join(words)}: {violation}"


class CampaignTableTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            results = pathlib.Path(folder) / "results"
            run = [PROGRAM, "--all", str(results), "--first", CASES]
            subprocess.run(run, stdout=subprocess.DEVNULL, check=False)
            cls.text = results.read_text()
            with results.open("a") as file:  # as if it had been killed in a line
                file.write("mode hand boot 1\trunn")
            lines = results.read_text().splitlines(keepends=True)
            cls.cases = outcome_table.read(lines)

    def test_goes_on_with_its_own_results_alone(self):
        def run(count):
            done = subprocess.run([PROGRAM, "--all", str(results), "--first", str(count)], check=False,
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)  # fmt: skip
            return done.returncode, done.stdout

        with tempfile.TemporaryDirectory() as folder:
            results = pathlib.Path(folder) / "results"
            self.assertEqual(run(2), (0, "2 cases; 0 were there; 0 of both with violations\n"))
            stamp, first, *rest = results.read_text().splitlines(keepends=True)
            results.write_text("".join([stamp, first[:-2] + "bad: 0\n", *rest, "half a li"]))
            self.assertEqual(run(3), (1, "1 cases; 2 were there; 1 of both with violations\n"))
            results.write_text(results.read_text().replace(stamp, stamp[:-2] + "x\n"))
            code, text = run(1)
            self.assertEqual(code, 0)
            self.assertIn("begun anew\n1 cases; 0 were there", text)
            results.write_text("precious\n")
            self.assertEqual(run(1)[0], 2)
            self.assertEqual(results.read_text(), "precious\n")

    def test_a_sample_comes_to_what_the_page_says(self):
        self.assertEqual(len(self.cases), int(CASES))
        self.assertEqual(list(differences(self.cases, PAGE)), [])

    def test_the_page_is_what_its_results_say(self):
        table = outcome_table.parse(outcome_table.page(self.cases, len(self.cases)))
        self.assertEqual(list(differences(self.cases, outcome_table.page(self.cases, 1))), [])
        self.assertEqual(set(table), {outcome_table.key_of(words) for words, *_ in self.cases})

    def test_another_outcome_is_seen(self):
        for change in (lambda w, c, r, v: (w, "off (bus_down, quick stop)x", r, v),
                       lambda w, c, r, v: (w, c, r + 100000, v),
                       lambda w, c, r, v: (["mode", "nothing", "boot", "0"], c, r, v)):
            changed = [change(*self.cases[0])]
            self.assertEqual(len(list(differences(changed, PAGE))), 1)


if __name__ == "__main__":
    unittest.main()
