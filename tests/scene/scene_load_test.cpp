#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "support/hardware_files.h"

namespace tactus {
namespace {

using test::SceneFiles;

TEST(SceneLoad, PutsEveryValueInItsPlace) {
  const Scene scene = SceneFiles{}.load();
  const ControllerConfig& config = scene.controller;
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.robot_name, "three");
  EXPECT_EQ(scene.variant, "null_task");
  EXPECT_EQ(scene.joint_names, (std::vector<std::string>{"lift", "shoulder", "roll"}));
  EXPECT_EQ(scene.period_s, 0.001);
  EXPECT_EQ(scene.duration_s, 13.0);
  EXPECT_EQ(config.q_start, Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(config.weights, Vector3(0.5, 1, 1.5));
  EXPECT_EQ(config.limits.lower, Vector3(-1, -2, -kNoLimit));
  EXPECT_EQ(config.limits.upper, Vector3(0.5, 2, kNoLimit));
  EXPECT_EQ(config.limits.max_velocity, Vector3(0.7, 1.5, 2));
  EXPECT_EQ(config.limits.max_acceleration, Vector3(10, 20, 30));
  EXPECT_EQ(config.task.size, 2);
  EXPECT_EQ(config.task.components[0], 0);
  EXPECT_EQ(config.task.components[1], 1);
  EXPECT_FALSE(config.has_joint_limit_avoidance);
  ASSERT_EQ(config.task.trajectory.waypoints.size(), 1u);
  EXPECT_EQ(config.task.trajectory.waypoints[0].displacement_m, Vector3(0, 0.1, 0));
  EXPECT_EQ(config.task.trajectory.waypoints[0].speed_m_per_s, 0.05);
  EXPECT_EQ(config.task.trajectory.waypoints[0].ramp_s, 0.5);
}

TEST(SceneLoad, PutsTheWayBackToThePathInItsPlace) {
  const TaskGains without = SceneFiles{}.load().controller.gains.task;
  EXPECT_EQ(without.max_return_speed_m_per_s, kNoLimit);
  EXPECT_EQ(without.max_return_speed_rad_per_s, kNoLimit);
  EXPECT_EQ(without.wait_beyond_m, kNoLimit);
  EXPECT_EQ(without.wait_beyond_rad, kNoLimit);
  const TaskGains with = SceneFiles{}
                             .load({{"task.components", "[x, rz]"},
                                    {"task.wait_beyond_rad", "0.1"},
                                    {"task.max_return_speed_m_per_s", "0.25"},
                                    {"task.max_return_speed_rad_per_s", "0.5"},
                                    {"task.wait_beyond_m", "0.05"}})
                             .controller.gains.task;
  EXPECT_EQ(with.max_return_speed_m_per_s, 0.25);
  EXPECT_EQ(with.max_return_speed_rad_per_s, 0.5);
  EXPECT_EQ(with.wait_beyond_m, 0.05);
  EXPECT_EQ(with.wait_beyond_rad, 0.1);
}

TEST(SceneLoad, PutsTheLawInItsPlace) {
  const Scene scene = SceneFiles{}.load();
  ASSERT_TRUE(scene.controller.force_control);
  const ForceControlConfig& force = *scene.controller.force_control;
  EXPECT_EQ(force.variant, Variant::kNullTask);
  EXPECT_EQ(force.order, 2);
  EXPECT_TRUE(force.has_estimator);
  const ForceGains& gains = scene.controller.gains.force;
  EXPECT_EQ(gains.time_constant_s, 0.1);
  EXPECT_EQ(gains.activation_force_N, 3.8);
  EXPECT_EQ(gains.assumed_stiffness_N_per_m, 7000.0);
  EXPECT_EQ(gains.estimator.min_N_per_m, 20.0);
  EXPECT_EQ(gains.estimator.min_force_change_N, 0.2);
}

TEST(SceneLoad, PutsThePlantInItsPlace) {
  const Scene scene = SceneFiles{}.load();
  const PlantConfig& plant = scene.plant;
  EXPECT_EQ(plant.drive_lag_s, 0.01);
  EXPECT_EQ(plant.robot_stiffness_N_per_m, 5000.0);
  EXPECT_EQ(plant.modules[0].cover_radius_m, 0.05);
  EXPECT_EQ(plant.modules[0].channels.sample_period_s, 0.005);
  EXPECT_EQ(plant.modules[0].channels.calibration(2, 6), -0.3);
  EXPECT_EQ(plant.modules[0].channels.calibration(3, 5), -0.3);
  ASSERT_EQ(plant.obstacles.size(), 2u);
  EXPECT_EQ(plant.obstacles[0].stiffness_N_per_m, 60.0);
  EXPECT_EQ(plant.obstacles[0].vanishes_s, kNoLimit);
  EXPECT_TRUE(plant.obstacles[0].foam.empty());
  ASSERT_EQ(plant.obstacles[1].foam.size(), 1u);
  EXPECT_EQ(plant.obstacles[1].foam[0].until_force_N, 9.0);
}

TEST(SceneLoad, TakesAFifthRowForTheMomentAboutTheAxis) {
  SceneFiles files;
  const Scene four = files.load();
  EXPECT_FALSE(four.plant.modules[0].channels.moment_x);
  EXPECT_FALSE(four.controller.tactile_modules[0].feels_moment_x);
  const Scene five = files.load({{"robot.tactile_module.calibration",
                                  "[[1, -1, 0, 0, 1, -1, 0, 0], [0, 0, 1, -1, 0, 0, 1, -1],"
                                  " [0, 0, -0.1, 0.1, 0, 0, -0.3, 0.3],"
                                  " [0.1, -0.1, 0, 0, 0.3, -0.3, 0, 0],"
                                  " [0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.09]]"}});
  ASSERT_TRUE(five.plant.modules[0].channels.moment_x);
  EXPECT_EQ((*five.plant.modules[0].channels.moment_x)[7], 0.09);
  EXPECT_EQ(five.plant.modules[0].channels.calibration(3, 4), 0.3);
  EXPECT_TRUE(five.controller.tactile_modules[0].feels_moment_x);
}

TEST(SceneLoad, SwingsObstaclesAndLosesSamples) {
  SceneFiles files;
  const Scene scene = files.load({{"simulation.obstacles[1].swing", "{y_m: 0.02, frequency_hz: 3}"},
                                  {"simulation.tactile_module.lost_share", "0.25"}});
  EXPECT_EQ(scene.plant.obstacles[0].swing.frequency_hz, 0.0);
  EXPECT_EQ(scene.plant.obstacles[1].swing.x_m, 0.0);
  EXPECT_EQ(scene.plant.obstacles[1].swing.y_m, 0.02);
  EXPECT_EQ(scene.plant.obstacles[1].swing.frequency_hz, 3.0);
  EXPECT_EQ(scene.plant.modules[0].lost_share, 0.25);
}

TEST(SceneLoad, LimitsTheLog) {
  const Scene scene = SceneFiles{}.load({{"log", "{max_bytes: 5e6, keep: 2, min_free_bytes: 0}"}});
  EXPECT_EQ(scene.log.max_bytes, 5e6);
  EXPECT_EQ(scene.log.keep, 2);
  EXPECT_EQ(scene.log.min_free_bytes, 0.0);
}

TEST(SceneLoad, LeavesOutWhatNoSectionNames) {
  SceneFiles files;
  files.scene = "robot: robot.yaml\ntask: {trajectory: {hold: {}}}\nsimulation: {duration_s: 1}\n";
  const Scene scene = files.load();
  EXPECT_EQ(scene.variant, "none");
  EXPECT_EQ(scene.controller.q_start, Vector3(0, 0.5, -0.5)) << "the robot's home";
  EXPECT_EQ(scene.controller.weights, Vector3::Ones());
  EXPECT_EQ(scene.controller.task.size, 3);
  EXPECT_TRUE(scene.controller.task.trajectory.waypoints.empty());
  EXPECT_TRUE(scene.controller.tactile_modules.empty());
  EXPECT_FALSE(scene.controller.force_control);
  EXPECT_FALSE(scene.controller.has_joint_limit_avoidance);
  EXPECT_EQ(stageNames(scene.controller),
            (std::vector<std::string>{"trajectory", "kinematics", "pseudoinverse", "limits",
                                      "telemetry"}));
}

TEST(SceneLoad, MeasuresOnlyWithTheVariantNone) {
  const Scene scene = SceneFiles{}.load({{"controller.variant", "none"}});
  EXPECT_FALSE(scene.controller.tactile_modules.empty());
  EXPECT_FALSE(scene.controller.force_control);
  EXPECT_EQ(stageNames(scene.controller),
            (std::vector<std::string>{"trajectory", "kinematics", "pseudoinverse", "tactile_module",
                                      "limits", "telemetry"}));
}

TEST(SceneLoad, NamesAllStagesInTheOrderOfACycle) {
  const Scene scene =
      SceneFiles{}.load({{"redundancy.joint_limit_avoidance", "{}"}, {"redundancy.posture", "{}"}});
  EXPECT_EQ(stageNames(scene.controller),
            (std::vector<std::string>{"trajectory", "kinematics", "pseudoinverse",
                                      "joint_limit_avoidance", "posture", "tactile_module",
                                      "contact_space", "contact_transition", "control_law",
                                      "stiffness_estimator", "limits", "telemetry"}));
}

TEST(SceneLoad, LeadsToTheHomeOfTheRobotOrWhereItSays) {
  EXPECT_FALSE(SceneFiles{}.load().controller.q_posture);
  const Scene home = SceneFiles{}.load({{"redundancy.joint_limit_avoidance", "{}"},
                                        {"redundancy.posture", "{}"},
                                        {"start", "[0.1, 0.4, 0]"}});
  ASSERT_TRUE(home.controller.q_posture);
  EXPECT_EQ(*home.controller.q_posture, JointVector(Vector3(0.0, 0.5, -0.5)));
  const Scene elsewhere =
      SceneFiles{}.load({{"redundancy.joint_limit_avoidance", "{}"},
                         {"redundancy.posture", "{positions: [0.1, -0.2, 0.3], gain_per_s: 0.7}"}});
  EXPECT_EQ(*elsewhere.controller.q_posture, JointVector(Vector3(0.1, -0.2, 0.3)));
  EXPECT_EQ(elsewhere.controller.gains.posture.gain_per_s, 0.7);
  EXPECT_EQ(elsewhere.controller.gains.posture.max_speed_share, 0.05);
}

/// As the package installs it, in /etc/tactus.
TEST(SceneLoad, ExampleOfThePackageReturnsSlowlyAndWaits) {
  const std::pair<std::string, std::string> installed[] = {
      {"scene.yaml", "debian/scene.yaml"},
      {"scenes/base/crops9_contact.yaml", "config/scenes/base/crops9_contact.yaml"},
      {"scenes/base/crops9_line.yaml", "config/scenes/base/crops9_line.yaml"},
      {"robots/crops9/robot_with_lines.yaml", "config/robots/crops9/robot_with_lines.yaml"},
      {"robots/crops9/crops9.urdf", "config/robots/crops9/crops9.urdf"}};
  std::vector<SourceFile> files;
  for (const auto& [path, source] : installed) {
    std::ifstream in(std::string(TACTUS_SOURCE_DIR) + "/" + source);
    files.push_back({path, {std::istreambuf_iterator<char>(in), {}}});
  }
  const Scene scene = loadScene(files, {});
  EXPECT_EQ(scene.controller.gains.task.max_return_speed_m_per_s, 0.25);
  EXPECT_EQ(scene.controller.gains.task.wait_beyond_m, 0.05);
}

TEST(SceneLoad, WaypointsKeepTheirOrder) {
  const Scene scene =
      SceneFiles{}.load({{"task.trajectory.line", "null"},
                         {"task.trajectory.waypoints",
                          "[{displacement_m: [0.1, 0, 0], pause_s: 2}, {ramp_s: 0.1}]"}});
  const std::vector<Waypoint>& waypoints = scene.controller.task.trajectory.waypoints;
  ASSERT_EQ(waypoints.size(), 2u);
  EXPECT_EQ(waypoints[0].displacement_m, Vector3(0.1, 0, 0));
  EXPECT_EQ(waypoints[0].pause_s, 2.0);
  EXPECT_EQ(waypoints[1].ramp_s, 0.1);
  EXPECT_EQ(waypoints[1].pause_s, 0.0);
}

TEST(SceneLoad, AcceptsNumbersAsYamlSpellsThem) {
  EXPECT_EQ(SceneFiles{}.load({{"period_s", "1e-3"}}).period_s, 0.001);
  EXPECT_EQ(SceneFiles{}.load({{"period_s", ".001"}}).period_s, 0.001);
  EXPECT_EQ(SceneFiles{}.load({{"simulation.duration_s", "7."}}).duration_s, 7.0);
  EXPECT_EQ(SceneFiles{}
                .load({{"simulation.tactile_module.seed", "123456789012345"}})
                .plant.modules[0]
                .seed,
            123456789012345u);
}

TEST(SceneLoad, AcceptsOnePlusSign) {
  SceneFiles files;
  files.scene = test::replaced(files.scene, "time_constant_s: 0.1", "time_constant_s: +0.25");
  files.urdf = test::replaced(files.urdf, "upper=\"0.5\"", "upper=\"+5e-1\"");
  const Scene scene = files.load({{"simulation.tactile_module.seed", "+7"}});
  EXPECT_EQ(scene.controller.gains.force.time_constant_s, 0.25);
  EXPECT_EQ(scene.controller.limits.upper[0], 0.5);
  EXPECT_EQ(scene.plant.modules[0].seed, 7u);
}

TEST(SceneLoad, ReadsWindowsLineEndings) {
  SceneFiles files;
  std::string text;
  for (const char c : files.scene) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  files.scene = text;
  EXPECT_EQ(files.load().duration_s, 13.0);
}

TEST(Override, ReachesIntoLists) {
  const Scene scene = SceneFiles{}.load(
      {{"simulation.obstacles[1].foam[0].until_force_N", "5"}, {"start[2]", "-1"}});
  EXPECT_EQ(scene.plant.obstacles[1].foam[0].until_force_N, 5.0);
  EXPECT_EQ(scene.controller.q_start[2], -1.0);
}

TEST(Override, MakesSectionsAndTheLastOneWins) {
  const Scene scene = SceneFiles{}.load({{"redundancy.joint_limit_avoidance.gain", "2"},
                                         {"controller.damping", "0.7"},
                                         {"controller.damping", "0.9"}});
  ASSERT_TRUE(scene.controller.has_joint_limit_avoidance);
  EXPECT_EQ(scene.controller.gains.joint_limit_avoidance.gain, 2.0);
  EXPECT_EQ(scene.controller.gains.force.damping, 0.9);
  EXPECT_EQ(scene.overrides.size(), 3u);
}

TEST(Override, ReachesTheRobot) {
  const SceneFiles files = test::hardwareFiles();
  const Scene scene = files.load({{"robot.tactile_module.counts_per_N", "1e6"},
                                  {"robot.drives.joints[0].node_id", "3"},
                                  {"robot.drives.position_lag_s", "0.007"}});
  EXPECT_EQ(scene.plant.modules[0].channels.counts_per_N, 1e6);
  EXPECT_EQ(scene.hardware->tactile_modules.at(0).channels.counts_per_N, 1e6);
  EXPECT_EQ(scene.hardware->drives[2].node_id, 3) << "of the joint roll, which comes last";
  EXPECT_EQ(scene.plant.drive_lag_s, 0.007);
  EXPECT_FALSE(files.load({{"robot.gpio", "~"}}).hardware->gpio);
}

TEST(Override, OfTheRobotComesAfterItsPath) {
  const SceneFiles files;
  std::vector<SourceFile> sources = files.sources();
  sources[1].path = "elsewhere/robot.yaml";
  const Scene scene = loadScene(sources, {{"robot.drives.position_lag_s", "0.007"},
                                          {"robot", "elsewhere/robot.yaml"},
                                          {"robot.urdf", "robot.urdf"}});
  EXPECT_EQ(scene.plant.drive_lag_s, 0.007);
  EXPECT_EQ(scene.sources.at(2).path, "robot.urdf") << "relative to the scene";
}

TEST(Override, RemovesWithNull) {
  const Scene scene = SceneFiles{}.load({{"stiffness.estimate", "~"}, {"redundancy", "null"}});
  EXPECT_FALSE(scene.controller.force_control->has_estimator);
  EXPECT_EQ(scene.controller.weights, Vector3::Ones());
}

}  // namespace
}  // namespace tactus
