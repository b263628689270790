#!/usr/bin/env python3
"""Bad input to the program itself: exit code 1, one line on stderr, nothing written.

usage: bad_input_test.py TACTUS
"""
import fcntl
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

TACTUS = pathlib.Path(sys.argv.pop(1)).resolve()
CONFIG = pathlib.Path(__file__).resolve().parents[2] / "config"
GOOD = CONFIG / "scenes/scenario1_null_space.yaml"
SECOND = CONFIG / "scenes/scenario1_none.yaml"
SHORT = ("--set", "simulation.duration_s=0.1")
ONE_LINE = re.compile(r"\A[^\n]+:[1-9]\d*:[1-9]\d*: [^:\n]+: [^\n]+, expected [^\n]+\n\Z")


class BadInput(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_tactus(self, *arguments):
        return subprocess.run(
            [TACTUS, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=60
        )

    def expect_refused(self, scene, start, *settings):
        """`check` and `simulate` both refuse the scene, with a line that starts like this."""
        commands = (["check", scene], ["check", "--json", scene], ["simulate", scene, "-o", "out"])
        self.expect_all_refuse(commands, start, *settings)

    def expect_all_refuse(self, commands, start, *settings):
        before = sorted(self.folder.rglob("*"))
        sets = [argument for setting in settings for argument in ("--set", setting)]
        for command in commands:
            result = self.run_tactus(*command, *sets)
            self.assertEqual(result.returncode, 1, result)
            self.assertRegex(result.stderr, ONE_LINE)
            self.expect_taken_apart(result, "--json" in command)
            self.assertTrue(result.stderr.startswith(start), result.stderr)
        self.assertEqual(sorted(self.folder.rglob("*")), before, "something was written")

    def expect_taken_apart(self, result, as_json):
        """Who asks for JSON gets the parts of the line, too; nobody else anything but it."""
        if not as_json:
            self.assertEqual(result.stdout, "")
            return
        self.assertEqual(result.stdout.count("\n"), 1)
        error = json.loads(result.stdout)
        self.assertEqual((error["done"], error["error"] + "\n"), (False, result.stderr))
        line = "{file}:{line}:{column}: {key}: {problem}, {expected}\n".format(**error)
        self.assertEqual(line, result.stderr)

    def write(self, text):
        (self.folder / "scene.yaml").write_text(f"extends: {GOOD}\n{text}")
        return "scene.yaml"

    def test_good_scene_passes(self):
        result = self.run_tactus("check", self.write(""))
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_init(self):
        arm = CONFIG / "robots/ur5e/ur5e.urdf"
        self.expect_all_refuse([["init", "none.urdf", "-o", "arm"]], "none.urdf:1:1: -: ")
        self.expect_all_refuse([["init", arm, "-o", "arm"]], f"{arm}:1:1: tip: 2 links end the arm")
        (self.folder / "robot.yaml").write_text("mine")
        init = ["init", arm, "-o", ".", "--tip", "flange"]
        self.expect_all_refuse([init], "./robot.yaml:1:1: -: is there already")
        self.assertEqual((self.folder / "robot.yaml").read_text(), "mine")

    def test_calibrate(self):
        (self.folder / "pushes.yaml").write_text("module: link4\nrecords:\n  - {force_N: [0, 1]}\n")
        fit = [["calibrate", "fit", "pushes.yaml", GOOD], ["calibrate", "fit", "pushes.yaml", GOOD, "--json"]]
        self.expect_all_refuse(fit, "pushes.yaml:3:5: records[0]: a push before any zero")
        bus = CONFIG / "scenes/robots/ur5e_free.yaml"
        self.expect_all_refuse([["calibrate", "show", bus], ["calibrate", "record", bus, "-o", "new.yaml"]],
                               f"{bus}:1:1: robot: has no can section")
        self.assertEqual(self.run_tactus("calibrate", "fit", "pushes.yaml").returncode, 2)

    def test_unknown_key(self):
        self.expect_refused(self.write("tasks: {}\n"), "scene.yaml:2:1: tasks: ")

    def test_wrong_type(self):
        scene = self.write("controller:\n  damping: much\n")
        self.expect_refused(scene, "scene.yaml:3:12: controller.damping: ")

    def test_start_outside_limits(self):
        scene = self.write("start: [9, 0, 0, 0, 0, 0, 0, 0, 0]\n")
        self.expect_refused(scene, "scene.yaml:2:9: start[0]: ")

    def test_numbers_that_are_nan(self):
        """CLI11's own range lets them through."""
        daemon = TACTUS.with_name("tactusd")
        scene = CONFIG / "scenes/free_motion.yaml"
        for command in ([TACTUS, "scope", "--pre"], [TACTUS, "scope", "--hysteresis"], [TACTUS, "stream", "--rate"],
                        [TACTUS, "set", "controller.damping=0.7", "--for"], [TACTUS, "doctor", "--duration"],
                        [daemon, scene, "--duration"]):
            result = subprocess.run([*command, "nan"], capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual(result.returncode, 2, command)
            self.assertIn("nan not in", result.stderr)

    def test_usage_as_json(self):
        for command in (["check", "--json"], ["check", "a", "--json", "--no-such"], ["--json"]):
            result = self.run_tactus(*command)
            self.assertEqual(result.returncode, 2)
            self.assertIs(json.loads(result.stdout)["done"], False)
            self.assertNotEqual(result.stderr, "")

    def test_overloaded_bus(self):
        """More than 80 % of a bus is refused with the arithmetic; a little less is accepted. A
        simulation has no bus to overload, nor has the replay of its log."""
        free = CONFIG / "scenes/free_motion.yaml"
        start = f"{CONFIG}/robots/crops9/robot.yaml:19:7: can.buses[0]: can0 is overloaded: 3 x 115 "
        on_hardware = (["check", free], ["check", "--json", free], ["plant", free])
        self.expect_all_refuse(on_hardware, start, "period_s=0.0009")
        error = self.run_tactus("check", free, "--set", "period_s=0.0009").stderr
        shortest = re.search(r"expected at most 80 %: a period_s of at least ([0-9.]+) ", error)[1]
        self.assertLess(float(shortest), 0.001)
        accepted = self.run_tactus("check", free, "--set", f"period_s={shortest}")
        self.assertEqual((accepted.returncode, accepted.stderr), (0, ""))
        less = self.run_tactus("check", free, "--set", f"period_s={float(shortest) - 1e-5:.5f}")
        self.assertEqual(less.returncode, 1)
        simulate = ("simulate", free, *SHORT, "--set", "period_s=0.00025", "-o", ".")
        replay = ("replay", f"{free.stem}/run.ulg")
        for command in (simulate, replay):
            result = self.run_tactus(*command)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
        result = self.run_tactus("check", "--json", free)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        report = json.loads(result.stdout)
        self.assertEqual(report["hardware_stages"], ["can"])
        self.assertNotIn("can", report["stages"])
        self.assertEqual([bus["interface"] for bus in report["buses"]], ["can0", "can1", "can2"])
        for bus in report["buses"]:
            bits = sum(t["frames"] * t["bits_a_frame"] / t["period_s"] for t in bus["terms"])
            self.assertAlmostEqual(bus["bits_per_s"], bits)
            self.assertAlmostEqual(bus["share"], 0.758)
        text = self.run_tactus("check", free).stdout
        self.assertIn("\ncan2     3 x 115 (RPDO1) + ", text)
        self.assertNotIn("can3", text, "nobody reads the module")

    def test_commission_knows_no_moteus(self):
        scene = CONFIG / "scenes/robots/planar2_moteus.yaml"
        result = self.run_tactus("commission", scene)
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("the drive of joint shoulder is a moteus, expected ", result.stderr)

    def test_commission_names_the_joints_that_there_are(self):
        """An empty name, as of a variable that is not set, too: it would be all joints."""
        scene = CONFIG / "scenes/free_motion.yaml"
        for name, nearest in (("j22", "perhaps j2, "), ("elbow", ""), ("", "")):
            result = self.run_tactus("commission", scene, "--joint", name)
            self.assertEqual((result.returncode, result.stdout), (1, ""))
            self.assertRegex(result.stderr, r"--joint: '\w*' is no joint of the robot, expected "
                             f"{nearest}one of j1, j2, j3, j4, j5, j6, j7, j8, j9\n")

    def test_unstable_gains(self):
        """Refused for the robot; a simulation may show what they do."""
        scene = self.write("controller:\n  time_constant_s: 0.03\n")
        start = "scene.yaml:3:20: controller.time_constant_s: 0.03 s is unstable (one space) "
        for command in ([TACTUS, "check"], [TACTUS.with_name("tactusd")]):
            result = subprocess.run([*command, scene], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual((result.returncode, result.stdout), (1, ""), result)
            self.assertRegex(result.stderr, ONE_LINE)
            self.assertTrue(result.stderr.startswith(start), result.stderr)
        result = self.run_tactus("simulate", scene, *SHORT, "-o", "out")
        self.assertEqual((result.returncode, result.stderr), (0, ""), result)

    def test_covers_and_touches(self):
        """What is printed is the same in both ways, and no number is missing."""
        scene = CONFIG / "scenes/scenario1_multi_space.yaml"
        report = json.loads(self.run_tactus("check", "--json", scene).stdout)
        self.assertEqual([cover["link"] for cover in report["covers"]], ["link4"])
        self.assertEqual([touch["obstacle"] for touch in report["touches"]], [0])
        self.assertGreater(report["expected_peak"]["blow_peak_N"], 0)
        text = self.run_tactus("check", scene).stdout
        for name in ("cover", "touch", "peak", "gears"):
            self.assertEqual(text.count(f"\n{name:9}"), 1, text)
        self.assertNotIn("nan", text)

    def test_margins(self):
        multi_space = CONFIG / "scenes/scenario1_multi_space.yaml"
        report = json.loads(self.run_tactus("check", "--json", multi_space).stdout)["stability"]
        self.assertEqual(report["stiffness_ratio"], 1.0)
        loops = {loop["name"]: loop for loop in report["loops"]}
        self.assertAlmostEqual(loops["one space"]["largest_stiffness_ratio"], 4.83, places=2)
        self.assertAlmostEqual(loops["both spaces"]["largest_stiffness_ratio"], 2.42, places=2)
        self.assertAlmostEqual(loops["both spaces"]["phase_margin_deg"], 30.4, places=1)
        text = self.run_tactus("check", multi_space).stdout
        self.assertIn("\nmargins  both spaces: stable to c_e/c = 2.416; ", text)
        free = CONFIG / "scenes/free_motion.yaml"
        self.assertNotIn("stability", self.run_tactus("check", "--json", free).stdout)
        self.assertNotIn("margins", self.run_tactus("check", free).stdout)

    def test_trouble_on_no_bus(self):
        trouble = "{kind: drop, from_s: 1, until_s: 2, interface: can9}"
        scene = self.write(f"simulation:\n  troubles: [{trouble}]\n")
        self.expect_refused(scene, "scene.yaml:3:61: simulation.troubles[0].interface: ")

    def test_broken_yaml(self):
        self.expect_refused(self.write("start: [1, 2\n"), "scene.yaml:")

    def test_unknown_command(self):
        result = self.run_tactus("chek", "scene.yaml")
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertIn("chek, perhaps check", result.stderr)

    def test_tab(self):
        scene = self.write("task:\n\tdrift_gain_per_s: 5\n")
        self.expect_refused(scene, "scene.yaml:3:1: -: a tab in the indentation, expected spaces")

    def test_missing_colon(self):
        scene = self.write("simulation\n  duration_s: 5\n")
        self.expect_refused(scene, "scene.yaml:2:1: -: 'simulation' has no colon and space behind ")

    def test_folder_as_robot(self):
        (self.folder / "crops9").mkdir()
        scene = self.write("robot: crops9\n")
        self.expect_refused(
            scene, "scene.yaml:2:8: robot: crops9: is a folder, expected the path of a robot.yaml")

    def write_robot(self, change):
        folder = CONFIG / "robots/crops9"
        text = change((folder / "robot.yaml").read_text())
        (self.folder / "robot.yaml").write_text(
            text.replace("urdf: crops9.urdf", f"urdf: {folder}/crops9.urdf"))
        return self.write("robot: robot.yaml\n")

    def test_robot_is_wrong(self):
        """The error is in the robot's file and names the scene, too."""
        scene = self.write_robot(lambda text: text.replace("tip: tcp", "tip: tpc"))
        self.expect_refused(scene, "robot.yaml:4:6: tip: ")
        self.assertTrue(self.run_tactus("check", scene).stderr.endswith(" (for the scene scene.yaml)\n"))

    def test_daemon_that_is_refused_leaves_no_files(self):
        """No such buses here, whatever the machine has."""
        scene = self.write_robot(lambda text: text.replace("interface: can", "interface: absent"))
        before = sorted(self.folder.rglob("*"))
        result = subprocess.run([TACTUS.with_name("tactusd"), scene, "-o", "out"], cwd=self.folder,
                                capture_output=True, text=True, timeout=60)
        self.assertEqual((result.returncode, result.stdout), (3, ""), result)
        self.assertIn("absent0", result.stderr)
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def test_warnings_of_the_path(self):
        line = "task.trajectory.line"
        fast = ("--set", f"{line}.speed_m_per_s=10", "--set", f"{line}.ramp_s=0.05")
        for scene, settings, warnings in ((GOOD, (), 0), (GOOD, fast, 1)):
            report = json.loads(self.run_tactus("check", "--json", scene, *settings).stdout)
            self.assertEqual(len([w for w in report["warnings"] if w.startswith("path")]), warnings)
            text = self.run_tactus("check", scene, *settings).stdout
            self.assertEqual(text.count("\nwarning  path not followed: at "), warnings)
        both = (*fast, "--set", "stiffness.stiffest_N_per_m=25000")
        report = json.loads(self.run_tactus("check", "--json", GOOD, *both).stdout)
        first = [w.split(" ")[0] for w in report["warnings"]]
        self.assertEqual([w for w in first if w in ("path", "phase")], ["path", "phase"], report)
        self.assertNotIn("warnings", report["stability"])

    def test_setting(self):
        start = "--set controller.damping:1:1: controller.damping: "
        self.expect_refused(GOOD, start, "controller.damping=-1")

    def test_setting_without_value(self):
        self.expect_refused(GOOD, "--set:1:1: ", "controller.damping")

    def test_missing_file(self):
        self.expect_refused("gone.yaml", "gone.yaml:1:1: -: ")

    def test_folder(self):
        (self.folder / "scene.yaml").mkdir()
        self.expect_refused("scene.yaml", "scene.yaml:1:1: -: ")

    def test_fifo(self):
        os.mkfifo(self.folder / "scene.yaml")
        self.expect_refused("scene.yaml", "scene.yaml:1:1: -: ")

    def test_fifo_as_log(self):
        os.mkfifo(self.folder / "run\n.ulg")
        for command in (["replay"], ["export", "-o", "out.csv"]):
            result = self.run_tactus(*command, "run\n.ulg")
            self.assertEqual((result.returncode, result.stdout), (1, ""), result)
            self.assertRegex(result.stderr, ONE_LINE)

    def test_log_as_its_own_output(self):
        self.run_tactus("simulate", GOOD, *SHORT, "-o", ".")
        log = f"{GOOD.stem}/run.ulg"
        size = (self.folder / log).stat().st_size
        for command in ("replay", "export"):
            for output in (log, "."):
                result = self.run_tactus(command, log, "-o", output)
                self.assertEqual((result.returncode, result.stdout), (1, ""), result)
                self.assertRegex(result.stderr, ONE_LINE)
        self.assertEqual((self.folder / log).stat().st_size, size)

    def test_binary(self):
        (self.folder / "scene.yaml").write_bytes(bytes(range(256)))
        self.expect_refused("scene.yaml", "scene.yaml:1:1: -: ")

    def test_one_bad_scene_stops_all(self):
        result = self.run_tactus("simulate", GOOD, "gone.yaml", "-o", "out")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(list(self.folder.iterdir()), [])

    def expect_output_refused(self, output, *options):
        """No scene runs; the one line names the path and -o."""
        result = self.run_tactus("simulate", GOOD, SECOND, *SHORT, "-o", output, *options)
        self.assertEqual(result.returncode, 1, result)
        self.assertRegex(result.stderr, ONE_LINE)
        self.expect_taken_apart(result, "--json" in options)
        self.assertIn(":1:1: -o: ", result.stderr)
        self.assertEqual(list(self.folder.rglob("run.ulg")), [])

    def test_output_in_a_file(self):
        (self.folder / "afile").write_text("")
        self.expect_output_refused("afile/x")
        self.expect_output_refused("afile", "--json")
        self.expect_output_refused("afile/a\nb")

    def test_output_without_a_name(self):
        self.expect_output_refused("")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_bad_folder_of_the_second_scene(self):
        (self.folder / "out").mkdir()
        (self.folder / "out" / SECOND.stem).write_text("a file")
        self.expect_output_refused("out")

    def test_summary_that_cannot_be_replaced(self):
        (self.folder / "out" / SECOND.stem / "summary.json" / "x").mkdir(parents=True)
        self.expect_output_refused("out")

    def test_failed_run_leaves_no_summary(self):
        folder = self.folder / "out" / GOOD.stem
        folder.mkdir(parents=True)
        (folder / "summary.json").write_text("stale")
        (folder / "run.ulg").symlink_to("/dev/full")
        result = self.run_tactus("simulate", GOOD, *SHORT, "-o", "out", "--json")
        self.assertEqual(result.returncode, 3, result)
        error = json.loads(result.stdout)
        self.assertEqual((error["done"], error["error"] + "\n"), (False, result.stderr))
        self.assertFalse((folder / "summary.json").exists())

    def test_folder_of_another_run(self):
        folder = self.folder / "out" / GOOD.stem
        folder.mkdir(parents=True)
        for name in ("run.ulg", "summary.json"):
            (folder / name).write_text("another's")
        held = os.open(folder, os.O_RDONLY)
        self.addCleanup(os.close, held)
        fcntl.flock(held, fcntl.LOCK_EX)
        self.expect_all_refuse([["simulate", GOOD, *SHORT, "-o", "out"]],
                               f"out/{GOOD.stem}:1:1: -o: another run writes there, expected another folder")
        self.assertEqual([(folder / name).read_text() for name in ("run.ulg", "summary.json")], ["another's"] * 2)
        fcntl.flock(held, fcntl.LOCK_UN)
        self.assertEqual(self.run_tactus("simulate", GOOD, *SHORT, "-o", "out").returncode, 0)

    def test_options_of_a_run_beside_reload(self):
        """They would be passed over."""
        for options in (["-o", self.folder], ["--name", "a"], ["--duration", "5"], ["--set", "controller.damping=1"],
                        [GOOD]):  # fmt: skip
            for arguments in (["--reload", *options], [*options, "--reload"]):
                result = subprocess.run([TACTUS.with_name("tactusd"), *arguments], capture_output=True, text=True)
                self.assertEqual(result.returncode, 2, arguments)
                self.assertIn("excludes", result.stderr)

    def test_files_without_a_name(self):
        self.assertEqual(self.run_tactus("simulate", GOOD, *SHORT, "-o", "out").returncode, 0)
        log = f"out/{GOOD.stem}/run.ulg"
        for command in (["replay", log, "-o", ""], ["scope", log, "-o", ""], ["scope", ""], ["contacts", ""],
                        ["stream", ""]):
            result = self.run_tactus(*command)
            self.assertEqual(result.returncode, 2, result)
            self.assertIn("no name, expected a path", result.stderr)
        result = subprocess.run([TACTUS.with_name("tactusd"), GOOD, "-o", ""], capture_output=True, text=True)
        self.assertEqual((result.returncode, "no name, expected a path" in result.stderr), (2, True), result)
        self.expect_all_refuse([["init", GOOD, "-o", ""]], "-:1:1: -o: no folder, expected a path")

    def test_names_of_runs_reach_no_terminal_as_commands(self):
        result = self.run_tactus("simulate", GOOD, *SHORT, "-o", "out", "--name", "a\x1b[31m\nb")
        self.assertEqual(result.returncode, 0, result)
        self.assertNotIn("\x1b", result.stdout)
        self.assertIn("a\\x1b[31m\\x0ab ", result.stdout)

    def test_folders_with_a_space_are_words_of_the_next_command(self):
        urdf = CONFIG / "robots/kuka_iiwa7/kuka_iiwa7.urdf"
        result = self.run_tactus("init", urdf, "--tip", "flange", "-o", "it's my arm")
        self.assertEqual(result.returncode, 0, result)
        check = result.stdout.splitlines()[-1].removeprefix("next ").split(";")[0]
        self.assertEqual(shlex.split(check), ["tactus", "check", "it's my arm/scene.yaml"])

    def test_names_of_links_break_no_line_of_capsules(self):
        name, link = "b&#10;c: 1&#27;[31m", '<link name="{}">{}</link>'
        mesh = '<collision><geometry><mesh filename="a.stl"/></geometry></collision>'
        joint = ('<joint name="j{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="0.3 0 0"/>'
                 '<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>')
        (self.folder / "arm.urdf").write_text(
            '<robot name="arm">' + link.format("a", "") + link.format(name, mesh) + link.format("d", "")
            + joint.format(1, "a", name) + joint.format(2, name, "d") + "</robot>")
        self.assertEqual(self.run_tactus("init", "arm.urdf", "-o", "arm").returncode, 0)
        result = self.run_tactus("check", "arm/scene.yaml", "--capsules")
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("  # b\\x0ac: 1\\x1b[31m: a mesh, of which no capsule is made", result.stdout)

    def test_full_standard_output(self):
        commands = (
            ["simulate", "--json", GOOD, *SHORT, "-o", "out"],
            ["simulate", GOOD, *SHORT, "-o", "out"],
            ["check", GOOD],
            ["--help"],
        )
        for command in commands:
            with open("/dev/full", "w") as full:
                result = subprocess.run(
                    [TACTUS, *command], cwd=self.folder, stdout=full, stderr=subprocess.PIPE, timeout=60
                )
            self.assertEqual(result.returncode, 3, result)
            self.assertEqual(result.stderr.count(b"\n"), 1, result)

    def test_names_of_runs(self):
        base = ["simulate", GOOD, "-o", "out", *SHORT]
        for name in (".", "..", "a/b", "/a"):
            self.expect_all_refuse([base + ["--name", name]], f"{name}:1:1: --name: ")
        self.assertEqual(self.run_tactus(*base, "--name", "").returncode, 1)
        self.expect_all_refuse([base + [SECOND, "--name", "a"]],
                               "a:1:1: --name: one folder for 2 scenes, expected one scene")

    def test_named_runs_of_one_scene_stay_side_by_side(self):
        for name in ((), ("--name", "stiff & slow")):
            result = self.run_tactus("simulate", GOOD, *SHORT, "-o", "out", *name)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
        for name in ("scenario1_null_space", "stiff & slow"):
            summary = json.loads((self.folder / "out" / name / "summary.json").read_text())
            self.assertEqual(summary["scene"], "scenario1_null_space")
            self.assertTrue((self.folder / "out" / name / "run.ulg").exists())

    def test_same_name_twice(self):
        result = self.run_tactus("simulate", GOOD, self.copy_of_good(), "-o", "out")
        self.assertEqual((result.returncode, result.stdout), (1, ""), result)
        self.assertRegex(result.stderr, ONE_LINE)

    def copy_of_good(self):
        folder = self.folder / "a\nb"
        folder.mkdir()
        (folder / GOOD.name).write_text(f"extends: {GOOD}\n")
        return folder / GOOD.name


unittest.main()
