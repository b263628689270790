#!/usr/bin/env python3
"""The JSON schemas against the loader and an independent validator: what is shipped passes both, and
what the table of keys does not allow is refused by both.

usage: schema_test.py TACTUS
"""
import copy
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import jsonschema
import yaml

TACTUS = pathlib.Path(sys.argv.pop(1)).resolve()
CONFIG = pathlib.Path(__file__).resolve().parents[2] / "config"


class Yaml12(yaml.SafeLoader):
    """Words mean what they mean in YAML 1.2: 1e6 is a number, yes is text."""

    yaml_implicit_resolvers = {}


for tag, pattern, first in (
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    ("bool", r"true|false", list("tf")),
    ("int", r"[-+]?\d+|0x[\da-fA-F]+", list("-+0123456789")),
    ("float", r"[-+]?(\.\d+|\d+(\.\d*)?)([eE][-+]?\d+)?", list("-+.0123456789")),
):
    Yaml12.add_implicit_resolver(f"tag:yaml.org,2002:{tag}", re.compile(f"^(?:{pattern})$"), first)

SCENE = """
robot: robot.yaml
period_s: 0.001
start: [0.05435, -0.55466, 0.46559, 0.45517, 0.44598, 0.91397, 1.07822, -0.66951, 0.58605]
task:
  components: [x, y, z, rz]
  drift_gain_per_s: 5
  max_return_speed_m_per_s: 0.25
  max_return_speed_rad_per_s: 0.5
  wait_beyond_m: 0.05
  wait_beyond_rad: 0.1
  trajectory:
    start_s: 0.5
    line: {displacement_m: [0, 0.4, 0], rotation_vector_rad: [0, 0, 0], speed_m_per_s: 0.05,
           angular_speed_rad_per_s: 0.5, ramp_s: 0.5}
redundancy:
  weights: [1, 1, 1, 1, 1, 1, 1, 1, 1]
  joint_limit_avoidance: {gain: 1, gradient_at_limit: 3.52, active_fraction: 0.5}
  posture: {positions: [0, 0, 0, 0, 0, 0, 0, 0, 0], gain_per_s: 0.5, max_speed_share: 0.1}
controller:
  variant: null_task
  level: velocity
  order: 2
  friction_coefficient: 0
  limit_at: auto
  time_constant_s: 0.1
  damping: 0.5
  contact_threshold_N: 1.2
  activation_force_N: 3.8
  max_null_speed_m_per_s: 5
  max_null_speed_rad_per_s: 5
  pull_gain_per_s: 500
  min_approach_stiffness_N_per_m: 300
  velocity_gain_per_s: 200
  transition: {max_time_constant_s: 1, distance_m: 0.05, engage_force_N: 0, release_force_N: 0.3,
               search_speed_m_per_s: 0.01}
stiffness:
  assumed_N_per_m: 7000
  stiffest_N_per_m: 7000
  estimate: {min_force_change_N: 0.2, filter_time_constant_s: 0.03, min_N_per_m: 10,
             max_N_per_m: 1e6}
clearance:
  safe_distance_m: 0.02
  influence_distance_m: 0.1
  avoid: {distance_m: 0.15, gain_per_s: 2}
  self_collision: true
  exclude: [{link: link4, other: link5}]
  keep_out: [{plane: {point_m: [9, 0, 0], normal: [-1, 0, 0]}, for: all}]
simulation:
  duration_s: 13
  arm: quasi_static
  drive_lag_s: 0.005
  drives:
    {bandwidth_hz: 8, damping_ratio: 0.7, dead_time_s: 0.008,
     max_acceleration: [9, 9, 9, 9, 9, 9, 9, 9, 9], feedback: motor}
  tactile_module:
    {filter_cutoff_hz: 15, cover: {mass_kg: 0.3, center_m: [0.19, 0, 0]}, quantised: true, noise_N: 0,
     lost_share: 0, jitter_s: 0, seed: 1, channel_gains: [1, 1, 1, 1, 1, 1, 1, 1],
     channel_drifts_N_per_s: [0, 0, 0, 0, 0, 0, 0, 0], direction_error_rad: 0}
  link_length_errors_m: [0, 0, 0, 0, 0, 0, 0, 0, 0]
  obstacles:
    - x_m: 0.7
      y_m: 0
      stiffness_N_per_m: 60
      foam: [{stiffness_N_per_m: 30, until_force_N: 1}]
      appears_s: 0
      vanishes_s: 10
      friction_coefficient: 0.3
      shear_stiffness_N_per_m: 3000
      slide_force_N: 20
      swing: {x_m: 0, y_m: 0.01, z_m: 0, frequency_hz: 1}
  troubles:
    - {kind: delay, from_s: 1, until_s: 2, interface: can0, id: 0x181, delay_s: 0.01}
real_time: {required: true}
log: {max_bytes: 1e9, keep: 4, min_free_bytes: 1e8}
"""


SHAPES = (
    {"sphere": {"center_m": [0.7, 0, 3], "radius_m": 0.1}},
    {"plane": {"point_m": [9, 0, 0], "normal": [-1, 0, 0]}},
    {"line": {"point_m": [0.7, 0, 0], "direction": [0, 0, 1]}},
    {"post": {"foot_m": [2, 0, 0], "axis": [0, 0, 1], "height_m": 1, "radius_m": 0.01}},
)


def load(text):
    return yaml.load(text, Yaml12)


def scene_files():
    return sorted((CONFIG / "scenes").rglob("*.yaml"))


def robot_files():
    return sorted((CONFIG / "robots").rglob("*.yaml"))


def tactus(*arguments, **options):
    return subprocess.run([TACTUS, *arguments], capture_output=True, text=True, timeout=60, **options)


def output(*arguments):
    result = tactus(*arguments)
    assert (result.returncode, result.stderr) == (0, ""), result
    return result.stdout


SCHEMAS = {name: json.loads(output("keys", "--schema", name)) for name in ("scene", "robot")}
VALIDATORS = {name: jsonschema.Draft202012Validator(schema) for name, schema in SCHEMAS.items()}
KEYS = json.loads(output("keys", "--json"))


def is_valid(name, tree):
    return VALIDATORS[name].is_valid(tree)


def steps_of(key):
    """`simulation.obstacles[].x_m` as names and the index of the first entry."""
    steps = []
    for word in key.split("."):
        steps += [word.removesuffix("[]"), 0] if word.endswith("[]") else [word]
    return steps


def find(tree, steps):
    """None where the tree does not have the way."""
    for step in steps:
        if tree is None or (isinstance(step, str) and step not in tree):
            return None
        tree = tree[step]
    return tree


class Case(unittest.TestCase):
    """Trees of whole files that have every key."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        crops9 = CONFIG / "robots/crops9"
        robot = load((crops9 / "robot_with_lines.yaml").read_text())
        robot["urdf"] = str(crops9 / robot["urdf"])
        robot["can"]["buses"][0] |= {"bit_rate_per_s": 1e6, "data_bit_rate_per_s": 5e6}
        sheets = {"eds": str(CONFIG.parent / "tests/fuzz/sheets/drive.eds"),
                  "profile": str(CONFIG / "profiles/zeroerr_edriver.yaml")}  # fmt: skip
        robot["drives"] |= sheets
        robot["drives"]["joints"][0] |= sheets
        robot["dynamics"] |= {"servo_bandwidth_hz": 40, "servo_integral_hz": 8}
        robot["gravity_m_per_s2"] = [0, 0, -9.81]
        robot |= {"module_lost": "stop", "module_lost_speed_share": 0.25}
        robot["tactile_module"]["cover"] = {
            "mass_kg": 0.3, "center_m": [0.19, 0, 0], "behind_gears": True}  # fmt: skip
        robot["collision_capsules"] = [
            {"link": "link5", "from_m": [0, 0, 0], "to_m": [0.12, 0, 0], "radius_m": 0.05}]  # fmt: skip
        for line in ("e_stop", "enable", "brake", "heartbeat"):
            robot["gpio"][line].setdefault("active_low", False)
        scene = load(SCENE)
        stops = copy.deepcopy(scene)
        stops["task"]["trajectory"] = {"waypoints": [dict(scene["task"]["trajectory"]["line"], pause_s=1)]}
        rests = copy.deepcopy(scene)
        rests["task"]["trajectory"] = {"hold": {}}
        told = copy.deepcopy(scene)
        del told["task"]["trajectory"]
        limits = ("max_speed_m_per_s", "max_acceleration_m_per_s2", "max_jerk_m_per_s3",
                  "max_speed_rad_per_s", "max_acceleration_rad_per_s2", "max_jerk_rad_per_s3",
                  "arrival_m", "arrival_rad", "give_up_after_s", "stream_timeout_s")  # fmt: skip
        told["task"] |= {"source": "commands", "commands": {key: 0.5 for key in limits} | {"start_measured": True}}
        shaped = []
        for shape in SHAPES:
            shaped.append(copy.deepcopy(scene))
            shaped[-1]["simulation"]["obstacles"] = [shape | {"stiffness_N_per_m": 60}]
            if "line" not in shape:
                shaped[-1]["clearance"]["keep_out"] = [copy.deepcopy(shape)]
        revolute_first = copy.deepcopy(robot)
        revolute_first["drives"]["joints"].append(revolute_first["drives"]["joints"].pop(0))
        listed = copy.deepcopy(robot)
        listed["tactile_modules"] = [listed.pop("tactile_module")]
        heavy = copy.deepcopy(scene)
        heavy["simulation"]["arm"] = "flexible_gears"
        del heavy["simulation"]["drive_lag_s"]
        torques = ("max_torque", "coulomb_friction", "viscous_friction", "backlash")
        heavy["simulation"]["drives"] = {key: [0.01] * 9 for key in torques}
        moteus = []
        for joint, unit in ((0, "m"), (1, "rad")):
            moteus.append(copy.deepcopy(robot))
            joints = moteus[-1]["drives"]["joints"]
            joints.insert(0, joints.pop(joint))
            joints[0] = {"joint": joints[0]["joint"], "interface": "can0", "kind": "moteus",
                         "node_id": joints[0]["node_id"], "home": "rotor",
                         f"turns_per_{unit}": 0.5}  # fmt: skip
        extending = scene | {"extends": str(CONFIG / "scenes/free_motion.yaml")}
        self.trees = {"scene": [scene, stops, rests, told, heavy, extending, *shaped],
                      "robot": [robot, revolute_first, listed, *moteus]}

    def tree_with(self, row):
        """A whole file that has the key, as a copy, and the map that the key is in."""
        steps = steps_of(row["key"])
        for tree in self.trees[row["file"]]:
            if find(tree, steps) is not None:
                tree = copy.deepcopy(tree)
                return tree, find(tree, steps[:-1]), steps[-1]
        self.fail(f"no file of this test has {row['key']}")

    def refusal(self, name, tree):
        """What tactus says about the file, in a pair of scene and robot."""
        files = {kind: trees[0] for kind, trees in self.trees.items()} | {name: tree}
        for kind, content in files.items():
            (self.folder / f"{kind}.yaml").write_text(json.dumps(content))  # which is YAML
        result = tactus("check", "scene.yaml", cwd=self.folder)
        self.assertIn(result.returncode, (0, 1), result)
        return result.stderr

    def expect_both_refuse(self, row, tree, at):
        shown = f"{row['file']}: {row['key']}: {tree!r}"
        error = self.refusal(row["file"], tree)
        self.assertIn(f": {at}", error, shown)
        self.assertFalse(is_valid(row["file"], tree), shown)


class Schema(Case):
    def test_is_a_schema(self):
        for schema in SCHEMAS.values():
            jsonschema.Draft202012Validator.check_schema(schema)

    def test_shipped_files_pass(self):
        for name, paths in (("scene", scene_files()), ("robot", robot_files())):
            self.assertGreater(len(paths), 5)
            for path in paths:
                errors = list(VALIDATORS[name].iter_errors(load(path.read_text())))
                self.assertEqual(errors, [], path)

    def test_whole_files_pass(self):
        for name, trees in self.trees.items():
            for tree in trees:
                self.assertEqual(self.refusal(name, tree), "")
                self.assertTrue(is_valid(name, tree))

    def test_wrong_types(self):
        wrong = {
            "number": ["fast", "0.1", True, [0.1], {"s": 0.1}],
            "integer": ["two", 1.5, True, [1], {}],
            "boolean": ["yes", 1, "true", []],
            "text": ["", [], {}],
            "choice": ["nothing of the kind", 1, []],
            "choice list": ["x", [], ["x", "x"], ["w"], {}],
            "number list": [0.1, [], [0.1], [0.1, "yes", 0.1], [0.1, None, 0.1], {}],
            "number table": [1, [[1] * 8] * 3, [[1] * 8] * 6, [[1] * 7] * 4, [["a"] * 8] * 4],
            "section": [1, "text", [1]],
            "section list": [1, "text", {}, [1]],
        }
        for row in KEYS:
            for value in wrong[row["type"]]:
                tree, parent, key = self.tree_with(row)
                parent[key] = value
                self.expect_both_refuse(row, tree, row["key"].replace("[]", "[0]"))

    def test_numbers_beyond_their_range(self):
        for row in (row for row in KEYS if row["type"] in ("number", "integer", "number list")):
            is_list = row["type"] == "number list"
            step = 1 if row["type"] == "integer" else 1e-6 * max(1, abs(row["lower"]))
            below = row["lower"] if row["is_lower_open"] else row["lower"] - step
            above = row["upper"] + (1 if row["type"] == "integer" else 1e-6 * row["upper"])
            for value in (below, above):
                tree, parent, key = self.tree_with(row)
                if is_list:
                    parent[key][0] = value
                else:
                    parent[key] = value
                self.expect_both_refuse(row, tree, row["key"].replace("[]", "[0]"))

    def test_numbers_at_the_ends_of_their_range(self):
        """Read by both. A missing file ends tactus before keys have to fit each other, which the
        schema leaves to it."""
        next_file = {"scene": "robot", "robot": "urdf"}
        for row in (row for row in KEYS if row["type"] in ("number", "integer")):
            for value in [row["upper"]] + ([] if row["is_lower_open"] else [row["lower"]]):
                tree, parent, key = self.tree_with(row)
                parent[key] = int(value) if row["type"] == "integer" else value
                tree[next_file[row["file"]]] = "gone.xml"
                self.assertTrue(is_valid(row["file"], tree), row)
                self.assertIn(f": {next_file[row['file']]}: gone.xml: ", self.refusal(row["file"], tree), row)

    def test_unknown_keys(self):
        sections = [row for row in KEYS if row["type"].startswith("section")]
        self.assertGreater(len(sections), 20)
        for row in sections:
            tree, parent, key = self.tree_with(row)
            section = parent[key][0] if row["type"] == "section list" else parent[key]
            section["colour"] = 1
            self.expect_both_refuse(row, tree, row["key"].replace("[]", "[0]"))
        for name, trees in self.trees.items():
            self.expect_both_refuse({"file": name, "key": ""}, trees[0] | {"colour": 1}, "colour: ")

    def test_required_keys(self):
        """Absent or null: refused where the key is required, else not by the schema."""
        for row in KEYS:
            for drop in (dict.pop, lambda parent, key: parent.update({key: None})):
                tree, parent, key = self.tree_with(row)
                drop(parent, key)
                if row["presence"] == "required":
                    self.expect_both_refuse(row, tree, row["key"].replace("[]", "[0]"))
                else:
                    self.assertTrue(is_valid(row["file"], tree), row)

    def test_a_scene_that_extends_another_needs_no_key(self):
        base = {"extends": "base.yaml"}
        self.assertTrue(is_valid("scene", base))
        self.assertFalse(is_valid("scene", {}))
        self.assertFalse(is_valid("scene", {"extends": None}))
        differing = ({"simulation": {"drive_lag_s": 0}}, {"task": None}, {"robot": None},
                     {"stiffness": {"estimate": {}}}, {"simulation": {"obstacles": []}})
        for more in differing:
            self.assertTrue(is_valid("scene", base | more), more)
            self.assertFalse(is_valid("scene", more), more)
        self.assertFalse(is_valid("scene", base | {"simulation": {"obstacles": [{"x_m": 1}]}}),
                         "lists are not merged")


class Keys(Case):
    def test_whole_table(self):
        text = output("keys")
        for row in KEYS:
            self.assertIn(f"\n  {row['key']}\n", text)
            self.assertIn(f"\n      {row['meaning']}\n", text)

    def test_one_key(self):
        text = output("keys", "controller.damping")
        self.assertEqual(text, "scene, see tactus-scene(5)\n  controller.damping\n"
                         "      a number > 0 and <= 10; default 0.5; symbol d; live\n"
                         "      how little the force overshoots: damping of the target dynamics (4), second "
                         "order only\n")
        self.assertEqual(output("keys", "damping"), text)

    def test_key_as_an_error_shows_it(self):
        rows = json.loads(output("keys", "--json", "simulation.obstacles[3].foam[0].until_force_N"))
        self.assertEqual([row["key"] for row in rows], ["simulation.obstacles[].foam[].until_force_N"])

    def test_section(self):
        rows = json.loads(output("keys", "--json", "stiffness.estimate"))
        self.assertEqual([row["key"] for row in rows], ["stiffness.estimate"] + [
            f"stiffness.estimate.{key}" for key in (
                "min_force_change_N", "filter_time_constant_s", "min_N_per_m", "max_N_per_m")])

    def test_files_of_both_kinds(self):
        rows = json.loads(output("keys", "--json", "real_time"))
        self.assertEqual({row["file"] for row in rows}, {"scene", "robot"})

    def test_several_keys_each_once(self):
        rows = json.loads(output("keys", "--json", "damping", "first_id", "controller.damping"))
        self.assertEqual([row["key"] for row in rows],
                         ["controller.damping", "tactile_modules[].first_id"])
        result = tactus("keys", "damping", "xyzzy")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertTrue(result.stderr.startswith("KEY:1:1: xyzzy: no such key"), result.stderr)

    def test_symbols_of_the_paper(self):
        for symbol, keys in (("T", ["controller.time_constant_s"]), ("d", ["controller.damping"]),
                             ("F_act", ["controller.activation_force_N"]),
                             ("beta", ["task.drift_gain_per_s", "controller.pull_gain_per_s"]),
                             ("c_0", ["stiffness.assumed_N_per_m"]),
                             ("T_t,max", ["controller.transition.max_time_constant_s"])):
            rows = json.loads(output("keys", "--json", symbol))
            self.assertEqual([row["key"] for row in rows], keys)
            self.assertEqual({row["symbol"] for row in rows}, {symbol})
            self.assertRegex(output("keys", symbol), f"; symbol {re.escape(symbol)}(; live|; free)?\n")

    def test_no_meaning_begins_with_a_symbol_or_an_equation(self):
        for row in KEYS:
            self.assertNotRegex(row["meaning"], r"^(\(\d|(alpha|beta|dH/dq|Algorithm|[TdWcF]|[a-zA-Z]_\S+)(:| of))")

    def test_unknown_key(self):
        for path, hint in (("controller.dampign", "expected perhaps 'damping'"),
                           ("xyzzy", "expected a key of a scene or of a robot")):
            result = tactus("keys", path)
            self.assertEqual((result.returncode, result.stdout), (1, ""))
            self.assertEqual(result.stderr, f"KEY:1:1: {path}: no such key, {hint}\n")


unittest.main()
