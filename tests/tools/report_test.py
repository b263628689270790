"""tools/report as a user runs it, on made-up runs whose numbers are known.

usage: report_test.py FOLDER, which has the package tactus as built, beside tactus-report"""

import html.parser
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path[:0] = [str(FOLDER), str(ROOT / "tools"), str(ROOT / "tests/support")]
sys.dont_write_bytecode = True

import tactus  # noqa: E402
from made_log import made_log, message  # noqa: E402
from tactus_report import bench_page, comparison, errors, figures, levels, logs, page, runs, series_figure  # noqa: E402

REPORT, TACTUS = FOLDER.with_name("tactus-report"), FOLDER.with_name("tactus")
SCENES = ROOT / "config/scenes"


def summary_of(scene, **changes):
    summary = {
        "scene": scene, "variant": "null_task", "outcome": "done", "peak_force_N": 8.0,
        "final_force_N": 5.0, "tcp_error_max_m": 0.08, "tcp_error_rms_m": 0.04,
        "tcp_error_final_m": 0.0788, "peak_joint_speed_squared": 0.2, "joints_at_limit_cycles": 0,
        "stiffness_at_peak_N_per_m": 1618.0, "real_time_factor": 1000.0,
        "step_time_ns": {"min": 500, "median": 700, "p99": 900, "max": 20000}}
    summary.update(changes)
    return summary


def write_run(folder, name, log=None, **changes):
    run = folder / name
    run.mkdir(parents=True)
    summary = summary_of(changes.pop("scene", name), **changes)
    (run / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    (run / "run.ulg").write_bytes(log_of() if log is None else log)
    return run


def simulate(scene, folder, *settings):
    """A short run of a scene of config."""
    options = [word for setting in ("simulation.duration_s=0.1", *settings) for word in ("--set", setting)]
    subprocess.run([TACTUS, "simulate", SCENES / f"{scene}.yaml", "-o", folder, *options], check=True,
                   capture_output=True)


CYCLES = 2600


def log_of(cycles=CYCLES, without=(), **changes):
    """13 s of a force that peaks between two plotted points."""
    time_s = 0.005 * np.arange(CYCLES)
    columns = {"t_s": time_s, "force_sensor_N": peaking(8.0), "stiffness_N_per_m": 30.0, "dq": [0.3, 0.4],
               "tool_error_x_m": 0.001, "tool_error_y_m": 0.002, "tool_error_z_m": 0.002, **changes}
    return made_log({name: value[:cycles] if isinstance(value, np.ndarray) else value
                     for name, value in columns.items()}, without=without)


def peaking(force_N):
    forces_N = np.arange(CYCLES) / 520
    forces_N[1667] = force_N
    return forces_N


def with_nan():
    values = np.ones(CYCLES)
    values[1000] = np.nan
    return values


class Report(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="a folder with spaces ")
        self.addCleanup(scratch.cleanup)
        self.use(scratch)

    def use(self, scratch):
        self.scratch = pathlib.Path(scratch.name)
        self.runs = self.scratch / "runs"

    def report(self, *arguments, program=REPORT, environment=None):
        command = [program, *(arguments or [self.runs])]
        return subprocess.run(command, capture_output=True, encoding="utf-8", env=environment)

    def page(self):
        return (self.runs / "report.html").read_text(encoding="utf-8")

    def refuse(self, expected, **options):
        """Exit code 1, one line that says what is wrong, and no page."""
        result = self.report(**options)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn(expected, result.stderr)
        self.assertFalse((self.runs / "report.html").exists())


class WholePage(Report):
    """All scenes; made once, read by all tests."""

    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory(prefix="a folder with spaces ")
        cls.addClassCleanup(cls.shared.cleanup)
        for scene in page.PAPER_SCENES | {"free_motion"}:
            write_run(pathlib.Path(cls.shared.name) / "runs", scene)
        cls.first = None

    def setUp(self):
        self.use(self.shared)
        if not WholePage.first:
            WholePage.first = self.report()
        self.assertEqual((self.first.returncode, self.first.stderr), (0, ""))

    def test_has_every_figure_as_well_formed_svg(self):
        svgs = re.findall(r"<svg.*?</svg>", self.page(), flags=re.DOTALL)
        self.assertEqual(len(svgs), 10)
        for svg in svgs:
            xml.etree.ElementTree.fromstring(svg)
        for number in range(2, 9):
            self.assertIn(f"Figure {number}. ", self.page())

    def test_needs_nothing_from_outside(self):
        class Links(html.parser.HTMLParser):
            found = []

            def handle_starttag(self, tag, attributes):
                self.found += [tag] if tag in ("script", "link", "img", "iframe") else []
                self.found += [value for name, value in attributes
                               if name in ("src", "href", "xlink:href") and value[:1] != "#"]

        links = Links()
        links.feed(self.page())
        self.assertEqual(links.found, [])
        self.assertEqual(re.findall(r"url\((?!#)|@import", self.page()), [])

    def test_ids_are_unique_and_references_resolve(self):
        ids = re.findall(r'\bid="([^"]*)"', self.page())
        self.assertEqual(len(ids), len(set(ids)))
        used = re.findall(r'(?:url\(#|href="#)([^)"]*)', self.page())
        self.assertTrue(used)
        self.assertEqual(set(used) - set(ids), set())

    def test_colours_come_from_the_page(self):
        self.assertEqual(re.findall(r"#0000\w\w\b", self.page()), [])
        self.assertIn("var(--orange", self.page())

    def test_is_the_same_to_the_byte_on_any_machine(self):
        before = self.page()
        (self.scratch / "matplotlibrc").write_text("lines.linewidth: 9\nfont.size: 30\n")
        environment = {"MATPLOTLIBRC": str(self.scratch), "PATH": os.environ["PATH"], "LC_ALL": "C"}
        result = self.report(environment=environment)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(self.page(), before)

    def test_ends_by_naming_the_page(self):
        self.assertEqual(self.first.stdout.splitlines()[-1],
                         f"report: {(self.runs / 'report.html').resolve()}")

    def test_labels_the_peak_between_plotted_points(self):
        self.assertIn("assumed, peak 8.00 N", self.page())

    def test_scenes_beyond_the_paper_have_their_own_table(self):
        further = self.page().split("<h2>Further runs, not of the paper</h2>")[1]
        self.assertEqual(re.findall(r'scope="row">(\w+)<', further), ["free_motion"])


FAULT = {"name": "following_error", "time_s": 3.214, "joint": "j<5>", "bus": "can1",
         "value": 0.0613, "limit": 0.05, "unit": "rad", "description": "a & b"}


class Levels(Report):
    def test_stand_beside_each_other_with_their_jerk(self):
        dq = np.tile([0.3, 0.4], (CYCLES, 1))
        dq[1000, 0] = 0.30005  # one cycle of 5 ms: +2, -4 and +2 rad/s^3
        write_run(self.runs, "scenario3_estimated", log_of(dq=dq))
        write_run(self.runs, "scenario3_acceleration")
        self.assertEqual(self.report().returncode, 0)
        table = self.page().split("<h2>Acceleration level</h2>")[1].split("</table>")[0]
        cells = re.findall(r"<t[hd][^>]*>([^<]*)</t[hd]>", table.split("<tbody>")[1])
        self.assertEqual(cells[0::7], ["scenario3_estimated", "scenario3_acceleration"])
        self.assertEqual(cells[4::7], ["4", "0"])
        for figure in ("Figure 13. ", "Figure 14. "):
            self.assertIn(figure, self.page())

    def test_no_run_of_the_acceleration_level_no_section(self):
        write_run(self.runs, "scenario3_estimated")
        self.assertEqual(self.report().returncode, 0)
        self.assertNotIn("Acceleration level", self.page())

    def test_margins_are_those_of_the_least_stable_loop(self):
        loops = [{"largest_stiffness_ratio": ratio, "phase_margin_deg": degrees}
                 for ratio, degrees in ((3.0, 41.25), (2.5, 60.0))]
        self.assertEqual(levels.least_stable(loops), ["2.50", "41.2"])

    def test_margins_are_those_of_the_run(self):
        for T_s in ("0.1", "0.2"):
            simulate("scenario3_acceleration", self.runs / T_s, f"controller.time_constant_s={T_s}")
            run, = runs.load_runs([self.runs / T_s])
            scene = tactus.Scene(SCENES / "scenario3_acceleration.yaml", set={"controller.time_constant_s": T_s})
            self.assertEqual(levels.margins(run), levels.least_stable(scene.check()["stability"]["loops"]))
            self.assertGreater(float(levels.margins(run)[1]), 10.0)

    def test_no_file_or_no_loop_no_margins(self):
        write_run(self.runs, "nowhere")
        simulate("free_motion", self.runs)
        for run in runs.load_runs([self.runs]):
            self.assertEqual(levels.margins(run), ["", ""])


class Faults(Report):
    def test_are_told_with_time_place_value_and_limit(self):
        write_run(self.runs, "x", fault=FAULT)
        write_run(self.runs, "y", fault=dict.fromkeys(FAULT) | {"name": "gpio_lost",
                                                                "description": "c"})
        write_run(self.runs, "z", fault=None)
        result = self.report()
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        section = self.page().split("<h2>Faults</h2>")[1].split("</table>")[0]
        rows = re.findall(r"<tr>(<th scope=.row.*?)</tr>", section)
        cells = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]
        self.assertEqual(cells, [
            ["x", "following_error", "3.214", "j&lt;5&gt;", "0.0613 rad", "0.05 rad", "a &amp; b"],
            ["y", "gpio_lost", "", "", "", "", "c"]])

    def test_no_fault_no_section(self):
        write_run(self.runs, "x")
        self.assertEqual(self.report().returncode, 0)
        self.assertNotIn("Faults", self.page())

    def test_a_fault_that_is_none_is_refused(self):
        for change, expected in (({"name": 3}, "fault.name"), ({"joint": 3}, "fault.joint"),
                                 ({"value": "x"}, "value: x"), ({"time_s": 1e999}, "time_s: inf")):
            with self.subTest(change=change):
                shutil.rmtree(self.runs, ignore_errors=True)
                write_run(self.runs, "x", fault=FAULT | change)
                self.refuse(expected)
        shutil.rmtree(self.runs)
        write_run(self.runs, "x", fault="tactile_stale")
        self.refuse("fault: no object")


class Unsensed(Report):
    def test_is_told_with_link_obstacle_force_and_time(self):
        contact = {"force_N": 219.123, "link": "link<5>", "obstacle": 0, "t_s": 6.51}
        write_run(self.runs, "x", unsensed_contact=contact)
        write_run(self.runs, "y", unsensed_contact={
            "force_N": 0.0, "link": None, "obstacle": None, "t_s": None})
        write_run(self.runs, "z")
        result = self.report()
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        section = self.page().split("<h2>Contact that no module feels</h2>")[1].split("</table>")[0]
        cells = re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", section.split("<tbody>")[1])
        self.assertEqual(cells, ["x", "link&lt;5&gt;", "0", "219.12", "6.510"])

    def test_none_no_section(self):
        write_run(self.runs, "z")
        self.assertEqual(self.report().returncode, 0)
        self.assertNotIn("no module feels", self.page())

    def test_one_that_is_none_is_refused(self):
        good = {"force_N": 1.0, "link": "a", "obstacle": 0, "t_s": 6.51}
        for bad in ("much", good | {"force_N": "x"}, good | {"link": None}, good | {"t_s": 1e999}):
            with self.subTest(bad=bad):
                shutil.rmtree(self.runs, ignore_errors=True)
                write_run(self.runs, "x", unsensed_contact=bad)
                self.refuse("unsensed_contact" if bad in ("much", good | {"link": None}) else "summary.json")


CONTACT = {"start_s": 1.25, "end_s": 3.5, "peak_force_N": 6.125, "settling_s": 0.5,
           "tactile_module": "link<4>", "rest_force_N": 5.0, "swing_N": 0.01,
           "stiffness_N_per_m": 7000.0, "tcp_error_max_m": 0.0123, "null_space_share": 0.25,
           "task_space_share": 0.6, "time_constant_s": 0.1, "damping": 0.5,
           "contact_stiffness_N_per_m": {"value": 1092.4, "low": 1091.0, "high": 1093.8}}


class Contacts(Report):
    def test_are_told_a_row_each(self):
        old = {key: CONTACT[key] for key in ("start_s", "end_s", "peak_force_N", "settling_s",
                                             "tactile_module")}
        write_run(self.runs, "x", contacts=[CONTACT, CONTACT | {"contact_stiffness_N_per_m": None}])
        write_run(self.runs, "y", contacts=[old])
        write_run(self.runs, "z", contacts=[])
        result = self.report()
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        section = self.page().split("<h2>Contacts</h2>")[1].split("</table>")[0]
        rows = re.findall(r"<tr>(<th scope=.row.*?)</tr>", section)
        cells = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]
        told = ["link&lt;4&gt;", "1.250", "3.500", "6.12", "0.500"]
        figures_of_it = ["5.00", "0.01", "7000", "1092 (1091 to 1094)", "12.3", "25", "60", "0.1", "0.5"]
        unknown = figures_of_it[:3] + [""] + figures_of_it[4:]
        self.assertEqual(cells, [["x", *told, *figures_of_it], ["x", *told, *unknown],
                                 ["y", *told, *[""] * 9]])

    def test_none_no_section(self):
        write_run(self.runs, "z", contacts=[])
        self.assertEqual(self.report().returncode, 0)
        self.assertNotIn("<h2>Contacts</h2>", self.page())

    def test_one_that_is_none_is_refused(self):
        for change, expected in (({"swing_N": "much"}, "swing_N"), ({"damping": 1e999}, "damping"),
                                 ({"contact_stiffness_N_per_m": 5}, "no object"),
                                 ({"contact_stiffness_N_per_m": {"value": 1, "low": None, "high": 2}}, "low")):
            with self.subTest(change=change):
                shutil.rmtree(self.runs, ignore_errors=True)
                write_run(self.runs, "x", contacts=[CONTACT | change])
                self.refuse(expected)


class Incomplete(Report):
    def test_names_the_missing_runs(self):
        write_run(self.runs, "scenario2_assumed")
        result = self.report()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("Missing: scenario2_estimated", self.page())
        self.assertNotIn("scenario1", self.page() + result.stdout)
        self.assertNotIn("scenario2_estimated missing", result.stdout)

    def test_leaves_the_paper_out_where_none_of_its_scenes_was_run(self):
        write_run(self.runs, "mine & yours")
        result = self.report()
        self.assertEqual(result.stdout, f"report: {(self.runs / 'report.html').resolve()}\n")
        for word in ("scenario", "Figure 2", "Paper", "Missing"):
            self.assertNotIn(word, self.page())
        self.assertIn("<h3>mine &amp; yours</h3>", self.page())
        self.assertIn("sensor force, peak 8.00 N", self.page())
        self.assertIn("TCP error, peak 3.00 mm", self.page())

    def test_says_in_the_table_which_run_is_missing(self):
        write_run(self.runs, "scenario3_assumed")
        self.assertIn("scenario3_estimated missing", self.report().stdout)

    def test_draws_no_figure_without_its_subject(self):
        for scene in ("scenario1_multi_space", "scenario3_tactus"):
            write_run(self.runs, scene)
        self.report()
        self.assertIn("Figure 11. ", self.page())
        self.assertNotIn("Figure 9. ", self.page())

    def test_takes_no_name_for_a_formula(self):
        write_run(self.runs, "a$\\frac$b")
        self.assertEqual(self.report().returncode, 0)

    def test_draws_no_force_of_a_run_without_any(self):
        write_run(self.runs, "free", log_of(force_sensor_N=0.0))
        self.assertEqual(self.report().returncode, 0)
        self.assertNotIn("Contact force", self.page())
        self.assertIn("Deviation of the tool", self.page())

    def test_accepts_what_a_scene_without_contact_leaves_out(self):
        write_run(self.runs, "free_motion", peak_force_N=None, stiffness_at_peak_N_per_m=None)
        self.assertEqual(self.report().returncode, 0)

    def test_shows_markup_in_names_as_text(self):
        write_run(self.runs, "x", scene="<script>", outcome="a & b")
        self.assertEqual(self.report().returncode, 0)
        self.assertNotIn("<script>", self.page())
        self.assertIn("a &amp; b", self.page())

    def test_collects_several_folders(self):
        for scene in ("scenario2_assumed", "scenario2_estimated"):
            write_run(self.runs / scene, scene)
        output = self.scratch / "page.html"
        folders = [self.runs / "scenario2_assumed", self.runs / "scenario2_estimated"]
        self.assertEqual(self.report(*folders, "-o", output).returncode, 0)
        self.assertNotIn("Missing: scenario2", output.read_text(encoding="utf-8"))


class Unwritten(Report):
    def setUp(self):
        super().setUp()
        write_run(self.runs, "one")

    def run_report(self, *arguments, **more):
        return subprocess.run([REPORT, self.runs, *arguments], stderr=subprocess.PIPE, text=True, **more)

    def test_a_full_disk_leaves_the_page_that_was_there(self):
        self.report()
        before = self.page()
        result = self.run_report(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)),
                                 stdout=subprocess.DEVNULL)
        self.assertEqual((result.returncode, result.stderr),
                         (1, f"{self.runs / 'report.html'}: cannot be written: File too large\n"))
        self.assertEqual(self.page(), before)
        self.assertEqual(sorted(path.name for path in self.runs.iterdir()), ["one", "report.html"])

    def test_a_device_is_written_to(self):
        result = self.run_report("-o", "/dev/full", stdout=subprocess.DEVNULL)
        self.assertEqual((result.returncode, result.stderr),
                         (1, "/dev/full: cannot be written: No space left on device\n"))
        self.assertEqual(self.run_report("-o", "/dev/null", stdout=subprocess.DEVNULL).returncode, 0)

    def test_a_path_that_is_no_text_is_told(self):
        result = self.run_report("-o", os.fsencode(self.scratch) + b"/p\xff.html", stdout=subprocess.PIPE,
                                 env={**os.environ, "PYTHONIOENCODING": "utf-8:strict"})
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertTrue(result.stdout.endswith("/p\\udcff.html\n"), result.stdout)

    def test_standard_output_that_is_full_or_gone(self):
        with open("/dev/full", "w") as full:
            result = self.run_report(stdout=full)
        self.assertEqual((result.returncode, result.stderr), (1, "standard output: cannot be written\n"))
        reading, writing = os.pipe()
        os.close(reading)
        result = self.run_report(stdout=writing)
        os.close(writing)
        self.assertEqual((result.returncode, result.stderr), (-signal.SIGPIPE, ""))


class OneScene(Report):
    """Several runs of it."""

    def test_are_overlaid_by_the_names_of_their_folders(self):
        for name in ("soft & slow", "stiff"):
            write_run(self.runs, name, scene="mine")
        self.assertEqual(self.report().returncode, 0)
        section = self.page().split("<h2>Runs of one scene</h2>")[1].split("<h2>")[0]
        self.assertIn("<h3>mine</h3>", section)
        self.assertEqual(section.count("<svg"), 2)
        for name in ("soft &amp; slow", "stiff"):
            self.assertIn(f"{name}, peak 8.00 N", section)
            self.assertIn(f"{name}, peak 3.00 mm", section)
        self.assertNotIn("<h3>", self.page().split("<h2>Runs</h2>")[1])

    def test_of_two_folders_have_their_folders_names(self):
        folders = [self.scratch / name for name in ("before", "after")]
        for folder in folders:
            write_run(folder, "mine")
            write_run(folder, "only_" + folder.name)
        output = self.scratch / "page.html"
        self.assertEqual(self.report(*folders, "-o", output).returncode, 0)
        text = output.read_text(encoding="utf-8")
        rows = re.findall(r'scope="row">([^<]+)<', text)
        self.assertEqual(rows, ["after/mine", "before/mine", "only_after", "only_before"])
        self.assertIn("before/mine, peak 8.00 N", text)

    def test_leave_the_papers_figures_to_the_run_with_the_scenes_name(self):
        for name, force_N in (("a_variation", 9.5), ("scenario2_estimated", 8.0)):
            log = log_of(force_sensor_N=peaking(force_N))
            write_run(self.runs, name, log, scene="scenario2_estimated")
        self.assertEqual(self.report().returncode, 0)
        figure = self.page().split("Figure 5. ")[0]
        self.assertIn("estimated, peak 8.00 N", figure)
        self.assertNotIn("peak 9.50 N", figure)
        self.assertIn("a_variation, peak 9.50 N", self.page())
        write_run(self.scratch / "others", "scenario2_estimated")  # so that its name has the folder's before it
        self.assertEqual(self.report(self.runs, self.scratch / "others").returncode, 0)
        self.assertIn("estimated, peak 8.00 N", self.page().split("Figure 5. ")[0])

    def test_leave_the_papers_figures_to_the_run_without_set(self):
        """Whichever folder comes first; a scene that was run with --set alone is marked."""
        folders = [self.scratch / name for name in ("varied", "plain")]
        for scene in ("scenario3_estimated", "scenario3_assumed", "scenario3_acceleration"):
            simulate(scene, folders[0])
        write_run(folders[1], "scenario3_estimated")
        write_run(folders[1], "free_motion")
        output = self.scratch / "page.html"
        for order in (folders, folders[::-1]):
            result = self.report(*order, "-o", output)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(" 0.00 N, 8.00 N, with --set ", result.stdout)  # assumed and estimated
            text = output.read_text(encoding="utf-8")
            self.assertIn("estimated, peak 8.00 N", text.split("Figure 7. ")[0])
            self.assertIn('"missing">With --set: scenario3_assumed: simulation.duration_s=0.1</p>', text)
            self.assertIn(">scenario3_acceleration, with --set<", text)
            self.assertNotIn("scenario3_estimated, with --set", text)
            self.assertIn(" varied/scenario3_estimated with --set simulation.duration_s=0.1.", text)  # overlaid

    def test_is_drawn_from_all_its_logs(self):
        """As tactusd writes them by log.max_bytes, run.2.ulg the oldest."""
        write_run(self.runs, "whole")
        self.assertEqual(self.report().returncode, 0)
        whole = self.page()
        cycles, head = made_log({"t_s": np.zeros(1)}), made_log({"t_s": np.zeros(0)})
        size, all_of_it = len(cycles) - len(head), log_of()
        for name, begin, end in (("run.2.ulg", 0, 1000), ("run.1.ulg", 1000, CYCLES - 1), ("run.ulg", CYCLES - 1, CYCLES)):
            part = all_of_it[len(head) + begin * size:len(head) + end * size]
            (self.runs / "whole" / name).write_bytes(head + part)
        self.assertEqual(self.report().returncode, 0)
        self.assertIn("sensor force, peak 8.00 N", self.page())
        self.assertEqual(self.page(), whole)

    def test_may_be_more_than_colours(self):
        for number in range(20):
            write_run(self.runs, f"run {number}", scene="mine")
        self.assertEqual(self.report().returncode, 0)
        for number in range(20):
            self.assertIn(f"run {number}, peak 8.00 N", self.page())


class Malformed(Report):
    def refuse_to_load(self, expected):
        """What refuse() prints; without a program for each of many cases."""
        with self.assertRaises(errors.InputError) as refusal:
            runs.load_runs([self.runs])
        self.assertIn(expected, str(refusal.exception))
        self.assertEqual(len(str(refusal.exception).splitlines()), 1)

    def test_no_folder(self):
        self.refuse(f"{self.runs}: no such folder, expected what `tactus simulate -o` wrote")

    def test_no_run(self):
        self.runs.mkdir()
        self.refuse("no run found")

    def test_no_argument_is_a_usage_error(self):
        result = subprocess.run([REPORT], capture_output=True)
        self.assertEqual(result.returncode, 2)

    def test_summaries(self):
        run = write_run(self.runs, "scenario1_none")
        good = summary_of("scenario1_none")
        broken = {
            "not readable as JSON": ["", "{", "\x00\x01", "[" * 100000, "9" * 5000],
            "not an object": ["[]", "3", "null"],
            "scene: missing": [json.dumps({**good, "scene": 3}), "{}"],
            "peak_force_N": [json.dumps({**good, "peak_force_N": value})
                             for value in ("8", True, [], float("nan"), float("inf"), 10**400)],
            "step_time_ns": [json.dumps({**good, "step_time_ns": 5})],
            "log: no object": [json.dumps({**good, "log": "stopped"})],
            "p99": [json.dumps({**good, "step_time_ns": {"median": 5}})],
            "tcp_error_rms_m: missing": [
                json.dumps({key: good[key] for key in good if key != "tcp_error_rms_m"})]}
        for expected, texts in broken.items():
            for text in texts:
                with self.subTest(text=text[:60]):
                    (run / "summary.json").write_text(text)
                    self.refuse_to_load(expected)
        self.refuse(expected)

    def test_logs(self):
        whole = log_of()
        broken = {
            "message F: no field t_s of type double": log_of(without=["t_s"]),
            "message F: no field tool_error_z_m of type double": log_of(without=["tool_error_z_m"]),
            "unknown type 0x78, an undamaged log is expected": whole + message(b"x", b"") + whole[-5000:],
            "longer than the log, an undamaged log is expected": whole + b"\xff\xffI",
            "the log ends here": whole[:200],
            "is empty": b"",
            "not a ULog file of version 1": b"t_s,force_sensor_N\n0,1\n1,2\n",
            "fewer than two cycles": log_of(cycles=1)}
        for expected, log in broken.items():
            with self.subTest(expected):
                write_run(self.runs, "scenario1_none", log)
                self.refuse_to_load(expected)
                self.refuse(f"{self.runs / 'scenario1_none/run.ulg'}:")
                shutil.rmtree(self.runs)
        write_run(self.runs, "scenario1_none", log_of(cycles=0))
        self.refuse_to_load("fewer than two cycles")

    def test_numbers_of_logs(self):
        for field in logs.NEEDED:
            with self.subTest(field):
                values = np.full((CYCLES, 2), 0.3) if field in ("dq", "q_measured") else with_nan()
                values[-1] = np.nan
                write_run(self.runs, "scenario1_none", log_of(**{field: values}))
                self.refuse_to_load(f"run.ulg: {field}: a number that is not finite")
                shutil.rmtree(self.runs)
        write_run(self.runs, "scenario1_none", log_of(stiffness_N_per_m=with_nan()))
        self.refuse("stiffness_N_per_m: a number that is not finite")

    def test_a_log_that_was_cut_off_is_shown_up_to_there(self):
        """And so is one that a full disk has stopped; page and standard error say so."""
        reason = "No space left on device"
        for log, changes, text in (
                (log_of()[:-20], {}, "cut: log ends at 12.990 s, before the run"),
                (log_of(), {"log": {"state": "stopped", "reason": reason, "files": 1, "removed_files": 0}},
                 f"cut: log ends at 12.995 s ({reason}), before the run"),
                (log_of(), {"log": {"state": "complete", "files": 1, "removed_files": 0}}, "")):
            run = write_run(self.runs, "cut", log)
            (run / "summary.json").write_text(json.dumps(summary_of("cut", **changes)), encoding="utf-8")
            result = self.report()
            self.assertEqual((result.returncode, result.stderr), (0, f"{text}\n" if text else ""))
            self.assertIn("sensor force, peak 8.00 N", self.page())
            self.assertEqual(re.findall(r"cut: log ends [^<]*", self.page()), [f"{text}."] if text else [])
            shutil.rmtree(self.runs)

    def test_binary_log(self):
        run = write_run(self.runs, "scenario1_none")
        (run / "run.ulg").write_bytes(bytes(range(256)) * 20)
        self.refuse("not a ULog file of version 1")

    def test_missing_log(self):
        (write_run(self.runs, "scenario1_none") / "run.ulg").unlink()
        self.refuse("run.ulg: missing")

    def test_one_folder_twice(self):
        write_run(self.runs, "scenario1_none")
        result = self.report(self.runs, self.runs / ".")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("scenario1_none: is there twice, expected once", result.stderr)


class Installed(Report):
    """Away from the source tree, with the module elsewhere."""

    def setUp(self):
        super().setUp()
        share = self.scratch / "usr/share/tactus/tools"
        shutil.copytree(ROOT / "tools/tactus_report", share / "tactus_report")
        shutil.copy(ROOT / "tools/report", share)
        self.program = self.scratch / "usr/bin/tactus-report"
        self.program.parent.mkdir()
        self.program.symlink_to("../share/tactus/tools/report")
        simulate("scenario3_acceleration", self.runs)

    def run_with(self, modules):
        return self.report(program=self.program, environment={**os.environ, "PYTHONPATH": str(modules)})

    def test_finds_its_module(self):
        result = self.run_with(FOLDER)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        row = self.page().split("<h2>Acceleration level</h2>")[1].split("</tbody>")[0]
        margins = levels.margins(*runs.load_runs([self.runs]))
        self.assertEqual(re.findall(r"<td>([^<]*)</td>", row)[-2:], margins)
        self.assertNotIn("", margins)

    def test_says_what_to_install_or_build_without_it(self):
        (self.scratch / "tactus.py").write_text("raise ModuleNotFoundError(\"No module named 'tactus'\")")
        result = self.run_with(self.scratch)
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertEqual(result.stderr, "No module named 'tactus'; install it: apt install "
                         "./build/package/python3-tactus_*.deb, or build it: cmake --build --preset release\n")
        self.assertFalse((self.runs / "report.html").exists())


class Bench(Report):
    """Pages of what `tactus bench -o` wrote."""

    PLOT = {"title": "a < b", "note": "$\\frac$", "table": "t", "x": "x", "y": "y", "x_label": "x in m",
            "y_label": "y in N", "x_scale": "linear", "y_scale": "log", "has_lines": True,
            "series": [{"label": "of $a$", "where": {"name": "a"}},
                       {"label": "of 2", "where": {"x": 2.0}}, {"label": "none", "where": {"x": 9}}]}

    def write(self, *plots):
        self.runs.mkdir(exist_ok=True)
        (self.runs / "goals.csv").write_text("goal,limit,measured,met\ng & h,1,0.123456,yes\n")
        (self.runs / "t.csv").write_text("name,x,y\na,1,0.1\n\"b, c\",2,\na,10,1e-17\na,20,0\n,,5\n")
        sections = [{"title": "<T>", "text": "x", "tables": ["t"], "plots": plots}]
        (self.runs / "report.json").write_text(json.dumps({"sections": sections}))

    def test_draws_what_is_asked_for(self):
        none = [{"label": "none", "where": {"name": "none"}}]
        self.write(self.PLOT, {**self.PLOT, "series": []}, {**self.PLOT, "x_scale": "log"},
                   {**self.PLOT, "x_scale": "log", "series": none})
        result = self.report()
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        text = self.page()
        for part in ("<h2>&lt;T&gt;</h2>", "a &lt; b", "of $a$", "g &amp; h", "<td>0.1235</td>",
                     "t.csv", ">b, c<", "<td>1e-17</td>"):
            self.assertIn(part, text)
        svgs = re.findall(r"<svg.*?</svg>", text, flags=re.DOTALL)
        self.assertEqual(len(svgs), 4)
        for svg in svgs:
            xml.etree.ElementTree.fromstring(svg)
        ids = re.findall(r'\bid="([^"]*)"', text)
        self.assertEqual(len(ids), len(set(ids)))

    def test_leaves_out_what_was_not_measured_or_has_no_place(self):
        rows = bench_page.read_table(self.written() / "t.csv")
        x, y = bench_page.points(rows, self.PLOT, {"name": "a"})
        self.assertEqual((x, y), ([1.0, 10.0, 20.0], [0.1, 1e-17, 0.0]))
        self.assertFalse(series_figure.fits(0.0, "log"))
        self.assertTrue(series_figure.fits(0.0, "linear"))
        self.assertFalse(series_figure.fits(float("nan"), "linear"))
        x, y = bench_page.points(rows, self.PLOT, {"x": 2})
        self.assertEqual(str((x, y)), "([2.0], [nan])")

    def written(self):
        self.write(self.PLOT)
        return self.runs

    def test_refuses_what_is_damaged(self):
        for change in ({"table": "none"}, {"x": "none"}, {"series": [{}]}, {"series": 3},
                       {"y": "name"}, {"x_scale": "none"}):
            with self.subTest(change):
                self.write({**self.PLOT, **change})
                with self.assertRaisesRegex(errors.InputError, "not what `tactus bench -o` wrote: "):
                    bench_page.build_page(self.runs)
        (self.runs / "report.json").write_text("[")
        self.refuse("not what `tactus bench -o` wrote: JSONDecodeError")
        self.written()
        (self.runs / "t.csv").unlink()
        self.refuse("t.csv")

    def test_needs_no_module(self):
        self.written()
        text = "import sys; sys.modules['tactus'] = None; sys.path.insert(0, sys.argv[1]); import tactus_report.bench_page"
        subprocess.run([sys.executable, "-c", text, ROOT / "tools"], check=True)

    def test_stands_alone(self):
        write_run(self.scratch / "others", "free")
        self.written()
        result = self.report(self.runs, self.scratch / "others")
        self.assertEqual(result.returncode, 1)
        self.assertIn("others: a second folder beside one of `tactus bench`, expected one", result.stderr)


class Comparison(unittest.TestCase):
    def test_reduction_and_difference(self):
        self.assertAlmostEqual(comparison.reduction_percent(17.7, 8.0)[0], 54.802, places=3)
        self.assertEqual(comparison.differences([9.9, 5.0], [10.0, 5.0]), "-1.0 %, +0.0 %")

    def test_every_scene_that_figures_and_table_name_exists(self):
        scenes = {key.split(":")[0] for row in comparison.read_data()["rows"]
                  for key in row["ours"]}
        scenes |= {scene for pair in levels.PAIRS for scene in pair}
        for scene in scenes | page.PAPER_SCENES:
            self.assertTrue((ROOT / f"config/scenes/{scene}.yaml").is_file(), scene)


class Demo(unittest.TestCase):
    def test_simulates_the_scenes_of_every_folder(self):
        scenes = ROOT / "config/scenes"
        folders = {file.parent.relative_to(ROOT) for file in scenes.rglob("*.yaml")}
        folders.remove(pathlib.Path("config/scenes/base"))  # which only others extend
        self.assertGreater(len(folders), 3)
        said = (ROOT / "tools/demo").read_text(encoding="utf-8")
        for folder in folders:
            self.assertIn(f" {folder}/*.yaml", said)


class Drawing(unittest.TestCase):
    def test_thinning_keeps_extremes_and_ends(self):
        x = np.arange(100000.0)
        y = np.sin(x / 3000)
        y[[4321, 77777]] = 5, -5
        thin_x, thin_y = figures.thinned(x, y)
        self.assertLess(len(thin_x), 2000)
        self.assertEqual((thin_y.max(), thin_y.min()), (5, -5))
        self.assertEqual((thin_x[0], thin_x[-1]), (0, 99999))
        self.assertTrue((np.diff(thin_x) > 0).all())

    def test_labels_keep_their_distance_and_order(self):
        generator = np.random.default_rng(7)
        for count in (1, 2, 5, 11):
            wished = sorted(generator.uniform(0, 1, count) ** 3)
            heights = figures.spread(wished, 0.075)
            self.assertEqual(len(heights), count)
            self.assertTrue((np.diff(heights) >= 0.075 - 1e-12).all(), heights)
            self.assertTrue(0.0 <= min(heights) and max(heights) <= 1.0 + 1e-12, heights)
        self.assertEqual(figures.spread([0.2, 0.6], 0.1), [0.2, 0.6])
        self.assertEqual(figures.spread([0.0, 0.0], 0.1), [0.0, 0.1])


if __name__ == "__main__":
    unittest.main()
