#!/usr/bin/env python3
"""`tactus bench`: what one command leaves, and what it says when it cannot.

usage: bench_test.py TACTUS
"""
import csv
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

TACTUS = pathlib.Path(sys.argv.pop(1)).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "config/scenes/free_motion.yaml"


class Bench(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def bench(self, *arguments, program=TACTUS, environment=None):
        return subprocess.run([program, "bench", *arguments], cwd=self.folder, capture_output=True,
                              text=True, timeout=300, env=environment)

    def read(self, name):
        with open(self.folder / "out" / name, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_leaves_tables_and_one_page(self):
        studies = ("--study", "pseudoinverse", "--study", "closed_loop")
        result = self.bench("--quick", *studies, "-o", "out", SCENE)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(str(self.folder / "out/report.html"), result.stdout)
        files = {path.name for path in (self.folder / "out").iterdir()}
        self.assertEqual(files, {"goals.csv", "report.html", "report.json", "pseudoinverse.csv",
                                 "closed_loop.csv", "closed_loop_stability.csv"})
        for row in self.read("pseudoinverse.csv"):
            self.assertGreater(float(row["time_ns"]), 0.0)
            self.assertGreater(float(row["error_max"]), 0.0)
        runs = self.read("closed_loop.csv")
        self.assertEqual([row["period_ms"] for row in runs], ["0.25", "1", "4"])
        self.assertEqual({row["outcome"] for row in runs}, {"stable"})
        page = (self.folder / "out/report.html").read_text(encoding="utf-8")
        self.expect_figures(page)
        for name in files - {"goals.csv", "report.html", "report.json"}:
            self.assertIn(f"<summary>{name}</summary>", page)
        page = re.sub(r'\bxmlns(:\w+)?="[^"]*"', "", page)
        for word in ("http", "<script", ">nan<", "inf\""):
            self.assertNotIn(word, page)

    def expect_figures(self, page):
        """Those that report.json asks for, with every series by its name."""
        plan = json.loads((self.folder / "out/report.json").read_text(encoding="utf-8"))
        plots = [plot for section in plan["sections"] for plot in section["plots"]]
        figures = re.findall(r"<figure.*?</figure>", page, re.DOTALL)
        self.assertEqual(len(figures), len(plots))
        self.assertGreaterEqual(len(plots), 8)
        for figure, plot in zip(figures, plots):
            xml.etree.ElementTree.fromstring(re.search(r"<svg.*</svg>", figure, re.DOTALL)[0])
            texts = re.findall(r">([^<>\n]+)<", figure)
            for text in [plot["title"], plot["x_label"], plot["y_label"],
                         *(series["label"] for series in plot["series"])]:
                self.assertIn(html.escape(text), texts)

    def test_leaves_its_tables_without_matplotlib(self):
        (self.folder / "matplotlib.py").write_text(
            "raise ModuleNotFoundError(\"No module named 'matplotlib'\")")
        result = self.bench("--quick", "--study", "pseudoinverse", "-o", "out",
                            environment={**os.environ, "PYTHONPATH": str(self.folder)})
        self.assertEqual(result.returncode, 0, result.stderr)
        last = result.stderr.splitlines()[-1]
        self.assertRegex(last, r"^no report\.html: No module named 'matplotlib'; .*apt-get install.*; "
                               r"the tables are in /.*/out, `tactus-report /.*/out` draws them$")
        self.assertNotIn("report.html", result.stdout)
        self.assertEqual({path.name for path in (self.folder / "out").iterdir()},
                         {"goals.csv", "report.json", "pseudoinverse.csv"})

    def test_json_is_all_that_is_printed(self):
        result = self.bench("--quick", "--json", "--study", "pseudoinverse")
        tables = json.loads(result.stdout)
        self.assertEqual(set(tables), {"goals", "pseudoinverse"})
        self.assertEqual(len(tables["goals"]), 4)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_tells_the_outcome_of_extremes(self):
        base = ROOT / "config/scenes/base/crops9_contact.yaml"
        result = self.bench("--quick", "--stability", "--json", "-o", "out", base)
        self.assertEqual(result.returncode, 0, result.stderr)
        tables = json.loads(result.stdout)
        self.assertEqual(set(tables),
                         {"goals", "extremes", "extremes_summary", "extremes_state"})
        for goal in tables["goals"]:
            self.assertEqual(goal["met"], "yes", goal)
        rows = self.read("extremes.csv")
        self.assertEqual(len(rows), len(tables["extremes"]))
        self.assertEqual(sum(row["rows"] for row in tables["extremes_summary"]), len(rows))
        self.assertTrue((self.folder / "out/report.html").exists())

    def test_tells_up_to_which_speed_a_body_is_pressed_within_its_limit(self):
        base = ROOT / "config/scenes/scenario2_estimated.yaml"
        result = self.bench("--quick", "--body", "--json", base)
        self.assertEqual(result.returncode, 0, result.stderr)
        tables = json.loads(result.stdout)
        runs = {}
        for row in tables["body_runs"]:
            runs.setdefault((row["law"], row["region"]), []).append(row)
        self.assertEqual(len(tables["body_speeds"]), len(runs))
        self.assertEqual(len(runs), 2 * 12)
        for row in tables["body_speeds"]:
            up_to = 0
            for run in runs[row["law"], row["region"]]:
                if run["peak_force_N"] > row["max_force_N"]:
                    break
                up_to = run["speed_m_per_s"]
            self.assertEqual(row["up_to_m_per_s"], up_to, row)
        self.assertEqual({row["up_to_m_per_s"] for row in tables["body_speeds"]}, {0, 0.1, 0.5})

    def test_knows_its_studies(self):
        self.assertEqual(self.bench("--study", "nothing").returncode, 2)
        result = self.bench("--help")
        self.assertEqual(result.returncode, 0)
        for study in ("pseudoinverse", "step", "closed_loop", "stability"):
            self.assertIn(study, result.stdout)

    def test_wants_scenes(self):
        result = self.bench("--study", "closed_loop", "--quick")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertRegex(result.stderr, r"\Aconfig/scenes:1:1: -: no scenes here, expected [^\n]+\n\Z")

    def test_finds_the_scenes_that_are_installed_with_it(self):
        programs = self.folder / "usr/bin"
        programs.mkdir(parents=True)
        for name in ("tactus", "tactus-bench"):
            shutil.copy(TACTUS.with_name(name), programs)
        data = self.folder / "usr/share/tactus"
        for name in ("robots", "scenes/base"):
            shutil.copytree(ROOT / "config" / name, data / name)
        shutil.copy(SCENE, data / "scenes")
        result = self.bench("--study", "closed_loop", "--quick", "--json", "-o", "out",
                            program=programs / "tactus")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(f"no report.html: {programs / 'tactus-report'}: cannot be run", result.stderr)
        (data / "tools").mkdir()
        shutil.copy(ROOT / "tools/report", data / "tools")
        shutil.copytree(ROOT / "tools/tactus_report", data / "tools/tactus_report")
        (programs / "tactus-report").symlink_to("../share/tactus/tools/report")
        rows = json.loads(result.stdout)["closed_loop"]
        self.assertEqual({row["scene"] for row in rows}, {"free_motion"})
        result = self.bench("--stability", "--quick", "--json", "-o", "out",
                            program=programs / "tactus")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.folder / "out/report.html").exists())

    def test_refuses_a_broken_scene(self):
        result = self.bench("--study", "closed_loop", "--quick", "gone.yaml")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertRegex(result.stderr, r"(?m)^gone\.yaml:1:1: ")

    def test_says_what_it_lacks(self):
        alone = shutil.copy(TACTUS, self.folder / "tactus")
        result = self.bench(program=alone)
        self.assertEqual((result.returncode, result.stdout), (3, ""))
        self.assertRegex(result.stderr, r"\A[^\n]*tactus-bench: cannot be run [^\n]*expected [^\n]*\n\Z")


if __name__ == "__main__":
    unittest.main()
