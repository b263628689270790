#include <gtest/gtest.h>

#include "support/scene_files.h"

namespace tactus {
namespace {

using test::BrokenText;
using test::SceneFiles;

class BrokenRobot : public testing::TestWithParam<BrokenText> {};

TEST_P(BrokenRobot, EndsAsOneLine) {
  SceneFiles files;
  files.robot = test::replaced(files.robot, GetParam().from, GetParam().to);
  test::expectError(test::loadError(files.sources()), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    All, BrokenRobot,
    testing::Values(
        BrokenText{"urdf: robot.urdf", "urdf: other.urdf", "robot.yaml:1:7: urdf: ",
                   "other.urdf: is not among the recorded files", "a readable file"},
        BrokenText{"urdf: robot.urdf\n", "", "robot.yaml:1:1: urdf: ", "is missing", "text"},
        BrokenText{"tip: tool", "tip: tol",
                   "robot.yaml:2:6: tip: ", "'tol' is no link of robot.urdf", "'tool'"},
        BrokenText{"tip: tool", "tip: nothing_like_it", "robot.yaml:2:6: tip: ", "is no link",
                   "the name of a link"},
        BrokenText{"tip: tool", "tip: base",
                   "robot.yaml:2:6: tip: ", "0 moving joints from 'base' to 'base'", "2 to 16"},
        BrokenText{"tip: tool", "tip: spacer", "robot.yaml:2:6: tip: ", "1 moving joints",
                   "2 to 16"},
        BrokenText{"tip: tool", "tip: gripper", "robot.urdf:28:3: joint.grip.type: ",
                   "'clutch' on the way to the tip", "prismatic, revolute, continuous or fixed"},
        BrokenText{"[0, 0.5, -0.5]", "[0, 0.5]", "robot.yaml:3:7: home: ", "a list of 2",
                   "3 numbers"},
        BrokenText{"[0, 0.5, -0.5]", "[0, 2.5, -0.5]", "robot.yaml:3:11: home[1]: ",
                   "outside the limits of joint 'shoulder'", "-2 to 2"},
        BrokenText{"[10, 20, 30]", "[10, 20]",
                   "robot.yaml:4:24: limits.acceleration: ", "a list of 2", "3 numbers"},
        BrokenText{"[10, 20, 30]", "[10, 20, -30]",
                   "robot.yaml:4:33: limits.acceleration[2]: ", "'-30' is out of range", "> 0"},
        BrokenText{"drives: {position_lag_s: 0.01}", "drives: {lag_ms: 10}",
                   "robot.yaml:6:10: drives.lag_ms: ", "unknown key", "position_lag_s"},
        BrokenText{"link: cover", "link: covers",
                   "robot.yaml:8:9: tactile_module.link: ", "'covers' is no link", "'cover'"},
        BrokenText{"link: cover", "link: base", "robot.yaml:8:9: tactile_module.link: ",
                   "'base' never moves", "at least one joint moves"},
        BrokenText{"link: cover", "link: gripper", "robot.yaml:8:9: tactile_module.link: ",
                   "moves with joint 'grip', which is not on the way to the tip",
                   "a link on the way to the tip or fixed to one"},
        BrokenText{"length_m: 0.4", "length_mm: 400",
                   "robot.yaml:9:3: tactile_module.length_mm: ", "unknown key", "'length_m'"},
        BrokenText{"cover_radius_m: 0.05", "cover_radius_m: 50",
                   "robot.yaml:10:19: tactile_module.cover_radius_m: ", "out of range",
                   "> 0 and <= 1 in m"},
        BrokenText{"sample_period_s: 0.005", "sample_period_s: 0.0045",
                   "robot.yaml:11:20: tactile_module.sample_period_s: ", "4.5 filter periods",
                   "a multiple"},
        BrokenText{"sample_period_s: 0.005", "counts_per_N: 1e7",
                   "robot.yaml:11:17: tactile_module.counts_per_N: ",
                   "with 1e+07 and this calibration a channel is at its end at 1.",
                   "so that more than 5 N are shown, the scene's activation_force_N + "},
        BrokenText{"sample_period_s: 0.005", "max_force_N: 5",
                   "robot.yaml:11:16: tactile_module.max_force_N: ",
                   "5 N is no more than where the arm rests",
                   "more than 5 N, the scene's activation_force_N + contact_threshold_N"},
        BrokenText{"sample_period_s: 0.005", "max_sample_age_s: 0.001",
                   "robot.yaml:11:21: tactile_module.max_sample_age_s: ",
                   "shorter than the sample period", "at least 0.004 s"},
        BrokenText{"sample_period_s: 0.005", "filter_cutoff_hz: 500",
                   "robot.yaml:11:21: tactile_module.filter_cutoff_hz: ", "500 Hz is too high",
                   "less than half the filter's rate of 1000 Hz"},
        BrokenText{"sample_period_s: 0.005", "filter_rate_hz: 2000\n  filter_cutoff_hz: 0.1",
                   "robot.yaml:12:21: tactile_module.filter_cutoff_hz: ", "0.1 Hz is too low",
                   "at least 0.2 Hz, 1e-4 of the filter's rate"},
        BrokenText{"[0, 0, 1, -1, 0, 0, 1, -1]", "[1, -1, 0, 0, 1, -1, 0, 0]",
                   "robot.yaml:13:5: tactile_module.calibration: ", "has rank 3",
                   "linearly independent"},
        BrokenText{"[0, 0, 1, -1, 0, 0, 1, -1]",
                   "[0, 0, 1, -1, 0, 0, 1, -1]\n    - [0, 0, 2, -2, 0, 0, 2, -2]",
                   "robot.yaml:13:5: tactile_module.calibration: ", "has rank 4",
                   "linearly independent"},
        BrokenText{"    - [0, 0, 1, -1, 0, 0, 1, -1]\n", "",
                   "robot.yaml:13:5: tactile_module.calibration: ", "a list of 3",
                   "a list of 4 to 5 lists of 8 numbers"},
        BrokenText{"[0, 0, 1, -1, 0, 0, 1, -1]", "[0, 0, 1, -1, 0, 0, 1]",
                   "robot.yaml:14:7: tactile_module.calibration[1]: ", "a list of 7", "8 numbers"},
        BrokenText{"[0, 0, 1, -1, 0, 0, 1, -1]", "[0, 0, 1, -1, 0, 0, 1, nan]",
                   "robot.yaml:14:30: tactile_module.calibration[1][7]: ", "'nan' is not finite",
                   "numbers"},
        BrokenText{"stiffness_N_per_m: 5000", "stiffness_N_per_m: 5000\nextends: other.yaml",
                   "robot.yaml:6:1: extends: ", "unknown key here", "in a scene"}));

TEST(RobotWithoutModule, CannotBeControlledByForce) {
  SceneFiles files;
  files.robot.resize(files.robot.find("tactile_module:"));
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:11:3: controller: ", "the robot has no tactile_module",
                     "no controller, or such a robot"});
}

TEST(RobotWithoutModule, IsFineWithoutController) {
  SceneFiles files;
  files.robot.resize(files.robot.find("tactile_module:"));
  const Scene scene = files.load({{"controller", "null"}});
  EXPECT_TRUE(scene.controller.tactile_modules.empty());
  EXPECT_FALSE(scene.controller.force_control);
}

}  // namespace
}  // namespace tactus
