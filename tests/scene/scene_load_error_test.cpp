#include <gtest/gtest.h>

#include "support/scene_files.h"
#include "tactus/scene/command_scene.h"

namespace tactus {
namespace {

using test::BrokenText;
using test::SceneFiles;

class BrokenScene : public testing::TestWithParam<BrokenText> {};

TEST_P(BrokenScene, EndsAsOneLine) {
  SceneFiles files;
  files.scene = test::replaced(files.scene, GetParam().from, GetParam().to);
  test::expectError(test::loadError(files.sources()), GetParam());
}

const std::string kLongWord(5000, 'a');
const std::string kDeepList = std::string(10000, '[') + std::string(10000, ']');

INSTANTIATE_TEST_SUITE_P(
    Keys, BrokenScene,
    testing::Values(
        BrokenText{"drift_gain_per_s", "drift_gain",
                   "scene.yaml:5:3: task.drift_gain: ", "unknown key", "'drift_gain_per_s'"},
        BrokenText{"controller:\n", "real_time: {priority: 70}\ncontroller:\n",
                   "scene.yaml:10:13: real_time.priority: ", "unknown key here",
                   "in the robot's file"},
        BrokenText{"controller:\n", "tactile_modules: [{link: cover}]\ncontroller:\n",
                   "scene.yaml:10:1: tactile_modules: ", "unknown key here", "in the robot's file"},
        BrokenText{"time_constant_s: 0.1", "time_constant_ms: 100",
                   "scene.yaml:12:3: controller.time_constant_ms: ", "unknown key",
                   "'time_constant_s'"},
        BrokenText{"variant: null_task", "variant: null_task\n  friction_coefficient: 0.3",
                   "scene.yaml:12:25: controller.friction_coefficient: ",
                   "null_task does not bear friction", "the variant null_limit"},
        BrokenText{"variant: null_task", "variant: null_task\n  limit_at: module_ends",
                   "scene.yaml:12:13: controller.limit_at: ",
                   "is of null_limit at the level velocity", "auto"},
        BrokenText{"variant: null_task", "variant: null_limit\n  limit_at: centre",
                   "scene.yaml:12:13: controller.limit_at: ", "'centre'", "stiffness_centre"},
        BrokenText{"variant: null_task", "variant: null_joint\n  level: acceleration",
                   "scene.yaml:12:10: controller.level: ", "acceleration has no variant null_joint",
                   "velocity, or the variant null_space, null_task or null_limit"},
        BrokenText{"variant: null_task", "variant: null_task\n  level: acceleration\n  order: 1",
                   "scene.yaml:13:10: controller.order: ", "1 with the level acceleration", "2"},
        BrokenText{"variant: null_task",
                   "variant: null_limit\n  level: acceleration\n  friction_coefficient: 0.3",
                   "scene.yaml:13:25: controller.friction_coefficient: ",
                   "0.3 with the level acceleration", "0, or the level velocity"},
        BrokenText{"redundancy:", "colour: blue\nredundancy:", "scene.yaml:8:1: colour: ",
                   "unknown key", "one of extends, robot"},
        BrokenText{"weights:", "joint_limit_avoidance: {alpha: 1}\n  weights:",
                   "scene.yaml:9:27: redundancy.joint_limit_avoidance.alpha: ", "unknown key",
                   "one of gain, gradient_at_limit, active_fraction"},
        BrokenText{"weights:", "posture: {q: [0, 0, 0]}\n  weights:",
                   "scene.yaml:9:13: redundancy.posture.q: ", "unknown key",
                   "one of positions, gain_per_s, max_speed_share"},
        BrokenText{
            "weights:", "posture: {positions: [0, 0]}\n  joint_limit_avoidance: {}\n  weights:",
            "scene.yaml:9:24: redundancy.posture.positions: ", "a list of 2", "3"},
        BrokenText{
            "weights:", "posture: {positions: [0, 9, 0]}\n  joint_limit_avoidance: {}\n  weights:",
            "scene.yaml:9:28: redundancy.posture.positions[1]: ", "9 is outside the limits",
            " to "},
        BrokenText{"weights:", "posture: {}\n  weights:",
                   "scene.yaml:9:3: redundancy.joint_limit_avoidance: ", "is missing",
                   "beside a posture"},
        BrokenText{"weights:", "posture: {gain_per_s: 11}\n  weights:",
                   "scene.yaml:9:25: redundancy.posture.gain_per_s: ", "'11' is out of range",
                   "0 to 10"},
        BrokenText{"weights:", "posture: {max_speed_share: 0}\n  weights:",
                   "scene.yaml:9:30: redundancy.posture.max_speed_share: ", "'0' is out of range",
                   "0.001 to 1"},
        BrokenText{"speed_m_per_s: 0.05", "pause_s: 1",
                   "scene.yaml:7:41: task.trajectory.line.pause_s: ", "unknown key", "ramp_s"},
        BrokenText{"duration_s: 13", "duration_s: 13\n  duration_s: 14",
                   "scene.yaml:19:3: simulation.duration_s: ", "given twice (first in line 18)",
                   "once"},
        BrokenText{"variant: null_task", "variant: null_task\n  'variant': none",
                   "scene.yaml:12:3: controller.variant: ", "given twice", "once"},
        BrokenText{"  duration_s: 13\n", "", "scene.yaml:18:3: simulation.duration_s: ",
                   "is missing", "a number > 0 and <= 86400 in s"},
        BrokenText{"robot: robot.yaml\n", "", "scene.yaml:1:1: robot: ", "is missing", "text"},
        BrokenText{"task:", "tasks:", "scene.yaml:3:1: tasks: ", "unknown key", "'task'"},
        BrokenText{"  components: [x, y]\n  drift_gain_per_s: 5\n  trajectory:\n    line: "
                   "{displacement_m: [0, 0.1, 0], speed_m_per_s: 0.05}\n",
                   "  ~\n", "scene.yaml:4:3: task: ", "is missing", "a section"},
        BrokenText{"components: [x, y]", "[x, y]: components",
                   "scene.yaml:4:3: task: ", "a list of 2 as a key", "a word"}));

INSTANTIATE_TEST_SUITE_P(
    Types, BrokenScene,
    testing::Values(
        BrokenText{"time_constant_s: 0.1", "time_constant_s: fast",
                   "scene.yaml:12:20: controller.time_constant_s: ", "'fast' is not a number",
                   "a number from 0.001 to 100 in s"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: '0.1'",
                   "scene.yaml:12:20: controller.time_constant_s: ", "the text '0.1'", "a number"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: 0.1 s",
                   "scene.yaml:12:20: controller.time_constant_s: ", "'0.1 s' is not a number",
                   "a number"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: 0,1",
                   "scene.yaml:12:20: controller.time_constant_s: ",
                   "'0,1' is not a number but has a decimal comma",
                   "a number from 0.001 to 100 in s, with a decimal point: 0.1"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: 0,1,2",
                   "scene.yaml:12:20: controller.time_constant_s: ", "'0,1,2' is not a number",
                   "in s"},
        BrokenText{"time_constant_s: 0.1", "order: 1,5", "scene.yaml:12:10: controller.order: ",
                   "'1,5' is not a whole number", "a whole number from 1 to 2"},
        BrokenText{"x_m: 0.7, y_m: 0.1,", "x_m: 0,7, y_m: 0.1,",
                   "scene.yaml:20:13: simulation.obstacles[0].x_m: ", "'0,7' has a decimal comma",
                   "a decimal point: 0.7"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: [0.1]",
                   "scene.yaml:12:20: controller.time_constant_s: ", "a list of 1", "a number"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: {s: 0.1}",
                   "scene.yaml:12:20: controller.time_constant_s: ", "a section", "a number"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s:",
                   "scene.yaml:12:3: controller.time_constant_s: ", "no value", "a number"},
        BrokenText{"time_constant_s: 0.1", "order: 1.5", "scene.yaml:12:10: controller.order: ",
                   "'1.5' is not a whole number", "a whole number from 1 to 2"},
        BrokenText{"[0.1, 0.2, 0.3]", "0.1", "scene.yaml:2:8: start: ", "'0.1'",
                   "a list of one number a joint"},
        BrokenText{"[0.1, 0.2, 0.3]", "[0.1, yes, 0.3]",
                   "scene.yaml:2:14: start[1]: ", "'yes' is not a number", "a list"},
        BrokenText{"[0.1, 0.2, 0.3]", "[0.1, ~, 0.3]", "scene.yaml:2:14: start[1]: ", "null",
                   "a list"},
        BrokenText{"[x, y]", "x", "scene.yaml:4:15: task.components: ", "'x'",
                   "a list of 1 to 6 distinct words"},
        BrokenText{"[x, y]", "[]", "scene.yaml:4:15: task.components: ", "a list of 0", "a list"},
        BrokenText{"[x, y]", "[x, w]", "scene.yaml:4:19: task.components[1]: ", "'w'",
                   "x, y, z, rx, ry, rz"},
        BrokenText{"[x, y]", "[x, x]",
                   "scene.yaml:4:19: task.components[1]: ", "'x' is given twice", "distinct"},
        BrokenText{"variant: null_task", "variant: nullspace",
                   "scene.yaml:11:12: controller.variant: ", "'nullspace'",
                   "one of none, null_space"},
        BrokenText{"[0, 0.1, 0]", "[0, 0.1]",
                   "scene.yaml:7:28: task.trajectory.line.displacement_m: ", "a list of 2",
                   "a list of 3 numbers"},
        BrokenText{"estimate: {min_N_per_m: 20}", "estimate: true",
                   "scene.yaml:16:13: stiffness.estimate: ", "'true'", "a section"},
        BrokenText{"estimate: {min_N_per_m: 20}",
                   "estimate:", "scene.yaml:16:3: stiffness.estimate: ", "no value", "a section"},
        BrokenText{"duration_s: 13", "duration_s: 13\n  tactile_module: {quantised: yes}",
                   "scene.yaml:19:31: simulation.tactile_module.quantised: ", "'yes'",
                   "true or false"},
        BrokenText{"duration_s: 13", "duration_s: 13\n  tactile_module: {seed: -1}",
                   "scene.yaml:19:26: simulation.tactile_module.seed: ", "'-1' is out of range",
                   "a whole number"},
        BrokenText{"robot: robot.yaml", "robot: ''", "scene.yaml:1:8: robot: ", "the text ''",
                   "text"},
        BrokenText{"    - {x_m: 0.7, y_m: 0.1, stiffness_N_per_m: 60}", "    - 60",
                   "scene.yaml:20:7: simulation.obstacles[0]: ", "'60'", "a section"}));

INSTANTIATE_TEST_SUITE_P(
    Ranges, BrokenScene,
    testing::Values(
        BrokenText{"drift_gain_per_s: 5", "drift_gain_per_s: -5",
                   "scene.yaml:5:21: task.drift_gain_per_s: ", "'-5' is out of range",
                   "from 0 to 10000 in 1/s"},
        BrokenText{"drift_gain_per_s: 5", "drift_gain_per_s: 1001",
                   "scene.yaml:5:21: task.drift_gain_per_s: ", "1001 is too high",
                   "at most 1 / period_s"},
        BrokenText{"drift_gain_per_s: 5", "drift_gain_per_s: nan",
                   "scene.yaml:5:21: task.drift_gain_per_s: ", "'nan' is not finite", "a number"},
        BrokenText{"drift_gain_per_s: 5", "drift_gain_per_s: -inf",
                   "scene.yaml:5:21: task.drift_gain_per_s: ", "'-inf' is not finite", "a number"},
        BrokenText{"drift_gain_per_s: 5", "drift_gain_per_s: .inf",
                   "scene.yaml:5:21: task.drift_gain_per_s: ", "'.inf' is not a number",
                   "a number"},
        BrokenText{"drift_gain_per_s: 5", "drift_gain_per_s: 1e999",
                   "scene.yaml:5:21: task.drift_gain_per_s: ", "'1e999' is out of range",
                   "a number"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: 0",
                   "scene.yaml:12:20: controller.time_constant_s: ", "'0' is out of range",
                   "from 0.001"},
        BrokenText{"activation_force_N: 3.8", "activation_force_N: 0",
                   "scene.yaml:13:23: controller.activation_force_N: ", "out of range", "> 0"},
        BrokenText{"assumed_N_per_m: 7000", "assumed_N_per_m: 0",
                   "scene.yaml:15:20: stiffness.assumed_N_per_m: ", "out of range", "> 0"},
        BrokenText{"weights: [1, 2, 3]", "weights: [1, 0, 3]",
                   "scene.yaml:9:16: redundancy.weights[1]: ", "'0' is out of range", "from 1e-06"},
        BrokenText{"robot: robot.yaml", "period_s: 0.1\nrobot: robot.yaml",
                   "scene.yaml:1:11: period_s: ", "out of range", "from 1e-05 to 0.02 in s"},
        BrokenText{"robot: robot.yaml", "period_s: 0.0015\nrobot: robot.yaml",
                   "scene.yaml:1:11: period_s: ", "does not fit the tactile module",
                   "a multiple or a whole part"},
        BrokenText{"duration_s: 13", "duration_s: 0.0009",
                   "scene.yaml:18:15: simulation.duration_s: ", "shorter than a cycle",
                   "at least period_s = 0.001"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: +-0.1",
                   "scene.yaml:12:20: controller.time_constant_s: ", "'+-0.1' is not a number",
                   "a number"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: ++0.1",
                   "scene.yaml:12:20: controller.time_constant_s: ", "'++0.1' is not a number",
                   "a number"},
        BrokenText{"stiffness_N_per_m: 60", "stiffness_N_per_m: -60",
                   "scene.yaml:20:47: simulation.obstacles[0].stiffness_N_per_m: ", "out of range",
                   "> 0"},
        BrokenText{"duration_s: 13", "duration_s: 1e9",
                   "scene.yaml:18:15: simulation.duration_s: ", "out of range", "<= 86400"}));

INSTANTIATE_TEST_SUITE_P(
    AgainstEachOther, BrokenScene,
    testing::Values(
        BrokenText{"weights: [1, 2, 3]", "weights: [1, 2]",
                   "scene.yaml:9:12: redundancy.weights: ", "a list of 2", "3 numbers"},
        BrokenText{"[0.1, 0.2, 0.3]", "[0.1, 0.2, 0.3, 0.4]",
                   "scene.yaml:2:8: start: ", "a list of 4", "3 numbers"},
        BrokenText{"[0.1, 0.2, 0.3]", "[0.6, 0.2, 0.3]", "scene.yaml:2:9: start[0]: ",
                   "0.6 is outside the limits of joint 'lift'", "-1 to 0.5"},
        BrokenText{"[x, y]", "[x, y, z, rx]", "scene.yaml:4:15: task.components: ", "a list of 4",
                   "at most 3"},
        BrokenText{"components: [x, y]", "components: [rz, rx]\n  wait_beyond_m: 0.05",
                   "scene.yaml:5:18: task.wait_beyond_m: ", "no position that could lag",
                   "x, y or z among task.components"},
        BrokenText{"drift_gain_per_s: 5", "wait_beyond_rad: 0.1",
                   "scene.yaml:5:20: task.wait_beyond_rad: ", "no orientation that could lag",
                   "rx, ry or rz among task.components"},
        BrokenText{"drift_gain_per_s: 5", "wait_beyond_m: 0",
                   "scene.yaml:5:18: task.wait_beyond_m: ", "'0' is out of range", "> 0"},
        BrokenText{"  activation_force_N: 3.8\n", "",
                   "scene.yaml:11:3: controller.activation_force_N: ", "is missing", "null_task"},
        BrokenText{"variant: null_task", "variant: joint_space",
                   "scene.yaml:9:3: redundancy.joint_limit_avoidance: ", "is missing",
                   "joint_space"},
        BrokenText{"weights: [1, 2, 3]\ncontroller:\n  variant: null_task",
                   "joint_limit_avoidance: {}\ncontroller:\n  variant: joint_space\n"
                   "  transition: {release_force_N: 1.2}",
                   "scene.yaml:12:33: controller.transition.release_force_N: ",
                   "not below the contact threshold", "less than"},
        BrokenText{"variant: null_task",
                   "variant: null_limit\n  limit_at: module_ends\n"
                   "  transition: {release_force_N: 1.2}",
                   "scene.yaml:13:33: controller.transition.release_force_N: ",
                   "not below the contact threshold", "less than"},
        BrokenText{"weights: [1, 2, 3]\ncontroller:\n  variant: null_task",
                   "joint_limit_avoidance: {}\ncontroller:\n  variant: joint_space\n"
                   "  pull_gain_per_s: 1001",
                   "scene.yaml:12:20: controller.pull_gain_per_s: ", "1001 is too high",
                   "at most 1 / period_s"},
        BrokenText{"stiffness:\n  assumed_N_per_m: 7000\n  estimate: {min_N_per_m: 20}\n", "",
                   "scene.yaml:1:1: stiffness: ", "is missing", "null_task"},
        BrokenText{"min_N_per_m: 20", "min_N_per_m: 20, max_N_per_m: 10",
                   "scene.yaml:16:44: stiffness.estimate.max_N_per_m: ", "not above min_N_per_m",
                   "more than 20"},
        BrokenText{"x_m: 0.7, y_m: 0.1,", "x_m: 0.7, y_m: 0.1, appears_s: 5, vanishes_s: 4,",
                   "scene.yaml:20:54: simulation.obstacles[0].vanishes_s: ", "4 s is too early",
                   "more than appears_s = 5"},
        BrokenText{"until_force_N: 9}",
                   "until_force_N: 9}, {stiffness_N_per_m: 1, until_force_N: "
                   "9}",
                   "scene.yaml:21:144: simulation.obstacles[1].foam[1].until_force_N: ",
                   "not above the layer before", "more than 9"},
        BrokenText{"line: {", "hold: {}\n    line: {", "scene.yaml:7:11: task.trajectory.hold: ",
                   "a second kind of motion", "one of line, waypoints, hold"},
        BrokenText{"    line: {displacement_m: [0, 0.1, 0], speed_m_per_s: 0.05}", "    start_s: 1",
                   "scene.yaml:7:5: task.trajectory: ", "no motion",
                   "one of line, waypoints, hold"},
        BrokenText{"[0, 0.1, 0]", "[0, 0, 0]",
                   "scene.yaml:7:11: task.trajectory.line: ", "does not move", "or hold"},
        BrokenText{"[0, 0.1, 0]", "[0, 5, 0]",
                   "scene.yaml:7:28: task.trajectory.line.displacement_m: ", "away from the base",
                   "the arm's reach"},
        BrokenText{"speed_m_per_s: 0.05", "rotation_vector_rad: [0, 3, 3]",
                   "scene.yaml:7:62: task.trajectory.line.rotation_vector_rad: ", "turns by",
                   "half a turn"},
        BrokenText{"speed_m_per_s: 0.05", "rotation_vector_rad: [0, 3.141592653589793, 0]",
                   "scene.yaml:7:62: task.trajectory.line.rotation_vector_rad: ", "turns by",
                   "no sense of rotation"},
        BrokenText{"speed_m_per_s: 0.05", "rotation_vector_rad: [0, 1, 0]",
                   "scene.yaml:7:62: task.trajectory.line.rotation_vector_rad: ",
                   "does not control the orientation", "rx, ry or rz among task.components"}));

INSTANTIATE_TEST_SUITE_P(
    Yaml, BrokenScene,
    testing::Values(
        BrokenText{"[0.1, 0.2, 0.3]", "[0.1, 0.2", "scene.yaml:2:8: -: ", "'[' is not closed",
                   "']' behind its last entry"},
        BrokenText{"[0.1, 0.2, 0.3]", "[0.1, 0.2}", "scene.yaml:2:17: -: ",
                   "'}' cannot close the '[' of line 2, column 8", "']' here"},
        BrokenText{"[0.1, 0.2, 0.3]", "]", "scene.yaml:2:8: -: ", "']' closes nothing",
                   "no such bracket"},
        BrokenText{"[0, 0.1, 0], speed", "[0, 0.1, 0, speed", "scene.yaml:7:59: -: ",
                   "'}' cannot close the '[' of line 7, column 28", "']' here"},
        BrokenText{"speed_m_per_s: 0.05}", "speed_m_per_s: 0.05  # '}' is missing",
                   "scene.yaml:7:11: -: ", "'{' is not closed", "'}' behind its last entry"},
        BrokenText{"[x, y]", "[[x, y] [z]]", "scene.yaml:4:23: -: ", "", "a comma or ]"},
        BrokenText{"  components", "\tcomponents",
                   "scene.yaml:4:1: -: ", "a tab in the indentation", "spaces"},
        BrokenText{"  drift_gain_per_s", "  \tdrift_gain_per_s",
                   "scene.yaml:5:3: -: ", "a tab in the indentation", "spaces"},
        BrokenText{"simulation:", "simulation  # all of it", "scene.yaml:17:1: -: ",
                   "'simulation' has no colon and space behind its key", "key: value"},
        BrokenText{"drift_gain_per_s: 5", "drift_gain_per_s:5\n\n  # and then",
                   "scene.yaml:5:3: -: ", "'drift_gain_per_s:5' has no colon and space",
                   "key: value"},
        BrokenText{"drift_gain_per_s: 5", "drift_gain_per_s: 5: 6  # don't 'do",
                   "scene.yaml:5:22: -: ", "illegal map value", "one key: value a line"},
        BrokenText{"null_task", "\"null_task", "scene.yaml:11:12: controller.variant: ",
                   "a quote that is not closed in its line", "the same quote"},
        BrokenText{"null_task", "'it''s # no comment\n  name: 'x'",
                   "scene.yaml:11:12: controller.variant: ",
                   "a quote that is not closed in its line", "the same quote"},
        BrokenText{"variant: null_task", "variant: |\n    no quote",
                   "scene.yaml:11:12: controller.variant: ", "'no quote\\x0a'", "one of none"},
        BrokenText{"[x, y]", "[\"x\", \"y\\\"]", "scene.yaml:4:21: task.components[1]: ",
                   "a quote that is not closed in its line", "the same quote"},
        BrokenText{"  drift_gain_per_s", " drift_gain_per_s",
                   "scene.yaml:5:2: -: ", "end of map not found", "indented alike"},
        BrokenText{"start:", "start: &q", "scene.yaml:2:8: start: ", "an anchor", "without anchor"},
        BrokenText{"[x, y]", "*q", "scene.yaml:4:15: -: ", "", "valid YAML"},
        BrokenText{"time_constant_s: 0.1", "time_constant_s: !!float 0.1",
                   "scene.yaml:12:20: controller.time_constant_s: ", "the tag", "without tag"},
        BrokenText{"simulation:", "---\nsimulation:", "scene.yaml:17:1: -: ", "a second document",
                   "one document"},
        BrokenText{"[0.1, 0.2, 0.3]", kDeepList, "scene.yaml:2:23: start", "nested too deeply",
                   "at most 16 levels"},
        BrokenText{"null_task", "\"a\\nb\\x1b[31m\"",
                   "scene.yaml:11:12: controller.variant: ", "'a\\x0ab\\x1b[31m'", "one of none"},
        BrokenText{"null_task", kLongWord, "scene.yaml:11:12: controller.variant: ", "aaa...'",
                   "one of none"},
        BrokenText{"drift_gain_per_s", "\"drift\\ngain\"",
                   "scene.yaml:5:3: task.drift\\x0again: ", "unknown key", "drift_gain_per_s"},
        BrokenText{"[x, y]", std::string_view("[x, \0y]", 7),
                   "scene.yaml:4:19: -: ", "byte 0x00 is no text", "UTF-8"},
        BrokenText{"[x, y]", "[x, \xff]", "scene.yaml:4:19: -: ", "byte 0xff is no text", "UTF-8"},
        BrokenText{"[x, y]", "[x, \xc0\xaf]", "scene.yaml:4:19: -: ", "byte 0xc0 is no text",
                   "UTF-8"}));

TEST(BrokenSceneFile, EmptyOrNoSection) {
  SceneFiles files;
  files.scene = "";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:1:1: -: ", "no value", "a section"});
  files.scene = "- 1\n- 2\n";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:1:1: -: ", "a list of 2", "a section"});
  files.scene = "just words";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:1:1: -: ", "'just words'", "a section"});
}

TEST(BrokenSceneFile, Truncated) {
  // Cut after every byte: never anything but a scene or a proper error.
  const SceneFiles whole;
  for (std::size_t length = 0; length < whole.scene.size(); ++length) {
    SceneFiles files;
    files.scene.resize(length);
    const std::string error = test::loadError(files.sources());
    if (error.empty()) continue;
    EXPECT_EQ(error.substr(0, 11), "scene.yaml:") << error;
    EXPECT_NE(error.find(", expected "), std::string::npos) << error;
  }
}

TEST(BrokenSceneFile, MoreCyclesThanARunMayHave) {
  const SceneFiles files;
  const std::vector<Override> settings = {{"period_s", "0.0001"},
                                          {"simulation.duration_s", "10001"}};
  test::expectError(test::loadError(files.sources(), settings),
                    {"", "", "--set simulation.duration_s:1:1: simulation.duration_s: ",
                     "more than 1e+08 cycles", "at most 10000 s"});
  EXPECT_EQ(files.load({settings[0], {"simulation.duration_s", "10000"}}).duration_s, 10000.0);
}

/// Of wait_beyond_m nothing could be said: missing, and of no use.
TEST(BrokenSceneFile, CommandsToAnOrientationAlone) {
  const SceneFiles files;
  const std::vector<Override> settings = {
      {"task.source", "commands"}, {"task.trajectory", "~"}, {"task.components", "[rx, rz]"}};
  test::expectError(test::loadError(files.sources(), settings),
                    {"", "", "--set task.components:1:1: task.components: ",
                     "no position, whose lag a task by commands waits for", "x, y or z"});
}

TEST(BrokenSceneFile, APostureWhereTheTaskTakesAllJoints) {
  test::expectError(
      test::loadError(SceneFiles{}.sources(), {{"task.components", "[x, y, z]"},
                                               {"redundancy.joint_limit_avoidance", "{}"},
                                               {"redundancy.posture", "{}"}}),
      {"", "", "--set redundancy.posture:1:1: redundancy.posture: ", "the task takes all joints",
       "fewer task.components"});
}

TEST(BrokenSceneFile, TactileSampleStaleWithinACycle) {
  SceneFiles files;
  files.robot = test::replaced(files.robot, "sample_period_s: 0.005",
                               "sample_period_s: 0.005\n  max_sample_age_s: 0.006");
  test::expectError(test::loadError(files.sources(), {{"period_s", "0.01"}}),
                    {"", "", "robot.yaml:12:21: tactile_module.max_sample_age_s: ",
                     "0.006 s is shorter than a cycle", "at least the scene's period_s = 0.01"});
  EXPECT_EQ(files.load({{"period_s", "0.005"}}).period_s, 0.005);
}

TEST(BrokenSceneFile, OverrideWithoutAKey) {
  test::expectError(test::loadError(SceneFiles{}.sources(), {{"", "1"}}),
                    {"", "", "--set :1:1: -: ", "is no path of keys", "section.key"});
}

TEST(BrokenSceneFile, OpenQuoteWhereTheTextEnds) {
  const char* const problem = "a quote that is not closed in its line";
  SceneFiles files;
  test::expectError(test::loadError(files.sources(), {{"controller.variant", "\"none"}}),
                    {"", "", "--set controller.variant:1:1: ", problem, "the same quote"});
  files.scene = "robot: 'robot.yaml";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:1:8: robot: ", problem, "the same quote"});
}

TEST(BrokenSceneFile, OpenQuoteBehindAByteOrderMark) {
  SceneFiles files;
  files.scene = "\xEF\xBB\xBF" + test::replaced(files.scene, "[x, y]", "['x', \"y\"]");
  EXPECT_EQ(test::loadError(files.sources()), "");
  files.scene = test::replaced(files.scene, "\"y\"", "\"y");
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:4:21: task.components[1]: ", "a quote that is not closed",
                     "the same quote"});
}

TEST(BrokenSceneFile, TooManyKeys) {
  SceneFiles files;
  for (int i = 0; i < 200; ++i) files.scene += "k" + std::to_string(i) + ": 1\n";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:115:1: ", "too many keys", "at most 100"});
}

TEST(BrokenSceneFile, TooManyObstacles) {
  SceneFiles files;
  for (int i = 0; i < 63; ++i) {
    files.scene += "    - {x_m: 0.7, y_m: 0.1, stiffness_N_per_m: 60}\n";
  }
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:20:5: simulation.obstacles: ", "a list of 65", "0 to 64"});
}

TEST(BrokenSceneFile, WithoutNameOfItsOwn) {
  std::vector<SourceFile> sources = SceneFiles{}.sources();
  sources[0].path = "...yaml";
  test::expectError(test::loadError(sources),
                    {"", "", "...yaml:1:1: -: ", "no name of its own", "name.yaml"});
}

TEST(BrokenSceneFile, NoFiles) {
  test::expectError(test::loadError({}),
                    {"", "", "-:1:1: -: ", "not among the recorded files", "a readable file"});
}

struct BrokenOverride {
  std::string_view key, value, place, problem, expectation;
};

class BrokenSetting : public testing::TestWithParam<BrokenOverride> {};

TEST_P(BrokenSetting, EndsAsOneLine) {
  const BrokenOverride& p = GetParam();
  test::expectError(
      test::loadError(SceneFiles{}.sources(), {{std::string(p.key), std::string(p.value)}}),
      {p.key, p.value, p.place, p.problem, p.expectation});
}

INSTANTIATE_TEST_SUITE_P(
    All, BrokenSetting,
    testing::Values(
        BrokenOverride{"controller.damping", "much",
                       "--set controller.damping:1:1: controller.damping: ",
                       "'much' is not a number", "a number"},
        BrokenOverride{"controller.dampin", "1", "--set controller.dampin:1:1: controller.dampin: ",
                       "unknown key", "'damping'"},
        BrokenOverride{"controller.dampin", "null",
                       "--set controller.dampin:1:1: controller.dampin: ", "unknown key",
                       "'damping'"},
        BrokenOverride{"simulation.obstacles[0].swing", "{x_m: 0.01, frequency_hz: 101}",
                       "--set simulation.obstacles[0].swing:1:27: "
                       "simulation.obstacles[0].swing.frequency_hz: ",
                       "has less than ten cycles a turn", "at most 100 Hz"},
        BrokenOverride{"simulation.obstacles[0].swing", "{z_m: 0.01, frequency_hz: 1}",
                       "--set simulation.obstacles[0].swing:1:7: "
                       "simulation.obstacles[0].swing.z_m: ",
                       "moves a vertical line along itself", "another shape"},
        BrokenOverride{"start", "[9, 0.2, 0]",
                       "--set start:1:2: start[0]: ", "9 is outside the limits", "-1 to 0.5"},
        BrokenOverride{"simulation.obstacles.x_m", "1",
                       "--set simulation.obstacles.x_m:1:1: simulation.obstacles.x_m: ",
                       "'x_m' is looked for in a list", "such as obstacles[0]"},
        BrokenOverride{"simulation.obstacles[2].x_m", "1",
                       "--set simulation.obstacles[2].x_m:1:1: simulation.obstacles[2].x_m: ",
                       "there is no entry 2", "below 2"},
        BrokenOverride{"simulation.duration_s[0]", "1",
                       "--set simulation.duration_s[0]:1:1: simulation.duration_s[0]: ",
                       "there is no entry 0: 'duration_s' is '", "no index"},
        BrokenOverride{"start[0][1]", "1", "--set start[0][1]:1:1: start[0][1]: ",
                       "there is no entry 1: 'start[0]' is '", "no index"},
        BrokenOverride{"controller[0]", "1", "--set controller[0]:1:1: controller[0]: ",
                       "there is no entry 0: 'controller' is a section", "a key in it, as "},
        BrokenOverride{"simulation.modules[0]", "1",
                       "--set simulation.modules[0]:1:1: simulation.modules[0]: ",
                       "there is no entry 0: 'modules' is not given",
                       "given as a list; `tactus keys` names"},
        BrokenOverride{"start[0].x", "1", "--set start[0].x:1:1: start[0].x: ", "'x' is no key",
                       "a key the scene knows"},
        BrokenOverride{"controller..damping", "1",
                       "--set controller..damping:1:1: controller..damping: ", "is no path of keys",
                       "section.key"},
        BrokenOverride{"start[-1]", "1", "--set start[-1]:1:1: start[-1]: ", "is no path of keys",
                       "section.key"},
        BrokenOverride{"a.b.c.d.e.f.g.h.i.j", "1",
                       "--set a.b.c.d.e.f.g.h.i.j:1:1: ", "is no path of keys", "section.key"},
        BrokenOverride{"start", "[0.1, ", "--set start:1:", "", "valid YAML"},
        BrokenOverride{"extends", "other.yaml", "--set extends:1:1: extends: ", "cannot be set",
                       "in a file"},
        BrokenOverride{"robot.tactile_module.counts_per_n", "1",
                       "--set robot.tactile_module.counts_per_n:1:1: tactile_module.counts_per_n: ",
                       "unknown key", "'counts_per_N'"},
        BrokenOverride{"robot.tactile_module.counts_per_N", "-1",
                       "--set robot.tactile_module.counts_per_N:1:1: "
                       "tactile_module.counts_per_N: ",
                       "'-1' is out of range", "> 0"},
        BrokenOverride{"robot.home[7]", "1", "--set robot.home[7]:1:1: robot.home[7]: ",
                       "there is no entry 7", "below 3"},
        BrokenOverride{"robot.limits.velocity[0]", "9",
                       "--set robot.limits.velocity[0]:1:1: robot.limits.velocity[0]: ",
                       "there is no entry 0: 'velocity' is not given",
                       "given as a list; `tactus keys` names"},
        BrokenOverride{"robot.home[0].x", "1", "--set robot.home[0].x:1:1: robot.home[0].x: ",
                       "'x' is no key", "a key the robot knows"},
        BrokenOverride{"robot.", "1", "--set robot.:1:1: robot.: ", "is no path of keys",
                       "section.key"},
        BrokenOverride{"robot.urdf", "gone.urdf", "--set robot.urdf:1:1: urdf: ", "gone.urdf",
                       "a readable file"},
        BrokenOverride{"simulation.duration_s", "",
                       "--set simulation.duration_s:1:1: "
                       "simulation.duration_s: ",
                       "no value", "a number"}));

TEST(Setting, IsSplitAtTheFirstEqualsSign) {
  const Override setting = parseOverride("a.b=c=d");
  EXPECT_EQ(setting.key, "a.b");
  EXPECT_EQ(setting.value, "c=d");
  EXPECT_THROW(parseOverride("a.b"), InputError);
  EXPECT_THROW(parseOverride("=1"), InputError);
}

TEST(Setting, IsGivenOnce) {
  const std::vector<std::string> settings = {"a.b=1", "a=2", "a.b.c=3", "a.bc=4"};
  EXPECT_EQ(parseOverrides(settings).size(), settings.size());
  for (const char* const again : {"a.b=2", "a.b=1"}) {
    try {
      parseOverrides({"a.b=1", "a.c=1", again});
      ADD_FAILURE() << again;
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(), "--set a.b:1:1: a.b: is given twice, expected each key once");
    }
  }
}

}  // namespace
}  // namespace tactus
