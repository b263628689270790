#include "tactus/scene/path_check.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "support/random.h"
#include "tactus/control/controller.h"
#include "tactus/math/trajectory.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

using Warnings = std::vector<std::string>;

/// The planar arm, whose joints reach 2 rad/s.
Warnings warningsOf(const std::vector<Override>& settings) {
  return checkPath(
      loadScene(TACTUS_SOURCE_DIR "/config/scenes/robots/planar2_free.yaml", settings));
}

/// As a warning writes it.
std::string pathEnd() {
  const Scene scene = loadScene(TACTUS_SOURCE_DIR "/config/scenes/robots/planar2_free.yaml", {});
  return fmt::format("{:g}", Trajectory(scene.controller.task.trajectory, Pose{}).end_s());
}

TEST(PathCheck, HasNothingAgainstTheScenesThatComeAlong) {
  int scenes = 0;
  const std::filesystem::path folder = TACTUS_SOURCE_DIR "/config/scenes";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    ++scenes;
    if (entry.path().filename() == "kuka_iiwa7_folding.yaml") continue;  // below
    EXPECT_EQ(checkPath(loadScene(entry.path().string(), {})), Warnings{}) << entry.path();
  }
  EXPECT_GT(scenes, 20);
}

TEST(PathCheck, WarnsOfAPathThatTheArmWouldHaveToTouchItselfFor) {
  const Warnings warnings = checkPath(
      loadScene(TACTUS_SOURCE_DIR "/config/scenes/whole_arm/kuka_iiwa7_folding.yaml", {}));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("path not followed: at 4."), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("the clearance or a singular pose"), std::string::npos);
}

/// The largest lag of the tool, m, where the way out of limits' zones begins gently or at once.
double largestLag(const Controller& controller, bool begins) {
  ControllerState state = controller.initialState();
  if (begins) controller.begin(state);
  const Gains& gains = controller.initialGains();
  ControllerOutput output;
  double lag = 0.0;
  for (int cycle = 0; cycle < 1500; ++cycle) {
    controller.update(RobotInput{}, gains, 0.002 * cycle, 0.002, state, output);
    lag = std::max(lag, output.error.norm());
  }
  return lag;
}

/// What leads a joint off its limit is back in time, also where the path moves from the first cycle
/// on.
TEST(PathCheck, APathIsFollowedFromAStartInALimitsZone) {
  ControllerConfig config =
      loadScene(TACTUS_SOURCE_DIR "/config/scenes/robots/kuka_iiwa7_free.yaml", {}).controller;
  config.force_control.reset();
  config.task.trajectory.start_s = 0.0;
  test::Random random(407);
  int followed = 0, led = 0;
  for (int draw = 0; draw < 60; ++draw) {
    for (int i = 0; i < config.q_start.size(); ++i)
      config.q_start[i] =
          random.uniform(0.95 * config.limits.lower[i], 0.95 * config.limits.upper[i]);
    Waypoint& to = config.task.trajectory.waypoints.front();
    to.displacement_m = 0.3 * random.vector<Vector3>(3, -1.0, 1.0).normalized();
    to.speed_m_per_s = 0.15;
    const Controller controller(config);
    if (largestLag(controller, false) > 1e-3) continue;
    ++followed;
    ControllerState state = controller.initialState();
    controller.begin(state);
    led += state.return_share == 0.0;
    EXPECT_LT(largestLag(controller, true), 2e-3) << draw;
  }
  EXPECT_GT(followed, 20);
  EXPECT_EQ(led, followed);
}

/// At its end the tool is where it shall be. Then joints that are led off their limits lean on what
/// the arm keeps clear of.
TEST(PathCheck, WarnsOfATargetThatTheClearanceTakesTheToolAwayFrom) {
  const std::string scene = TACTUS_SOURCE_DIR "/config/scenes/whole_arm/planar3_clutter.yaml";
  const auto warnings = [&](const std::string& duration_s) {
    return checkPath(loadScene(
        scene,
        {{"task.trajectory.start_s", "0.3"},
         {"task.trajectory.line", "{displacement_m: [-0.0208, 0.2349, 0], speed_m_per_s: 0.288}"},
         {"task.drift_gain_per_s", "1.8"},
         {"redundancy", "{joint_limit_avoidance: {}}"},
         {"robot.collision_capsules",
          "[{link: base, from_m: [0, 0, 0.3], to_m: [0, 0, 0.55], radius_m: 0.03}]"},
         {"clearance",
          "{safe_distance_m: 0.0155, influence_distance_m: 0.0373, self_collision: false, "
          "keep_out: [{post: {foot_m: [0.44705, -0.07663, 0.64422], height_m: 0.3093, "
          "axis: [-0.71781, -0.33696, -0.60927], radius_m: 0.043}}, {post: {foot_m: [0.32542, "
          "-0.19983, 0.28072], height_m: 0.4395, radius_m: 0.0487}, for: tool}]}"},
         {"simulation.obstacles", "[]"},
         {"simulation.duration_s", duration_s}}));
  };
  EXPECT_EQ(warnings("1.62"), Warnings{}) << "the path ends then";
  const Warnings later = warnings("12");
  ASSERT_EQ(later.size(), 1u);
  EXPECT_NE(later[0].find("end of the path not kept: at 1.6"), std::string::npos) << later[0];
}

TEST(PathCheck, WarnsOfASpeedBeyondThatOfAJoint) {
  const auto warningsAt = [](const std::string& speed_m_per_s) {
    const std::string line = "task.trajectory.line.";
    return warningsOf({{line + "displacement_m", "[-0.3, 0, 0]"},
                       {line + "speed_m_per_s", speed_m_per_s},
                       {line + "ramp_s", "0.2"}});
  };
  EXPECT_EQ(warningsAt("0.4"), Warnings{});
  const Warnings warnings = warningsAt("0.8");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("; joint elbow is at its largest speed of 2"), std::string::npos)
      << warnings[0];
}

/// By then the rotation vector of the tool has passed half a turn, where it changes its sign.
TEST(PathCheck, HasNothingAgainstAToolThatTurnsOverHalfATurn) {
  EXPECT_EQ(
      checkPath(loadScene(TACTUS_SOURCE_DIR "/config/scenes/robots/kuka_iiwa7_free.yaml",
                          {{"task.components", "[x, y, z, rx, ry, rz]"},
                           {"task.trajectory.line", "{rotation_vector_rad: [0.03, 0.3, 0]}"}})),
      Warnings{});
}

/// A reference that waits would hide it.
TEST(PathCheck, WarnsOfASpeedBeyondThatOfAJointThoughThePathWaits) {
  const std::string line = "task.trajectory.line.";
  const Warnings warnings = warningsOf({{line + "displacement_m", "[-0.3, 0, 0]"},
                                        {line + "speed_m_per_s", "0.8"},
                                        {line + "ramp_s", "0.2"},
                                        {"task.wait_beyond_m", "0.0001"}});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("path not followed"), std::string::npos) << warnings[0];
}

TEST(PathCheck, WarnsOfAStretchedArm) {
  const auto warningsAt = [](const std::string& elbow_rad) {
    return warningsOf({{"start", "[0.6, " + elbow_rad + "]"},
                       {"task.trajectory", "{hold: {}}"},
                       {"task.trajectory.line", "~"}});
  };
  EXPECT_EQ(warningsAt("-1.2"), Warnings{});
  const Warnings stretched = warningsAt("-0.001");
  ASSERT_EQ(stretched.size(), 1u);
  EXPECT_NE(stretched[0].find("singular start: smallest singular value "), std::string::npos)
      << stretched[0];
}

TEST(PathCheck, WarnsOfARunThatEndsBeforeItsPath) {
  EXPECT_EQ(warningsOf({{"simulation.duration_s", "2"}}),
            Warnings{"the simulation ends at 2 s, its path at " + pathEnd() + " s"});
}

TEST(PathCheck, TellsHowMuchOfALongPathItFollowed) {
  const std::string line = "task.trajectory.line.";
  const auto warningsAt = [&](const std::string& speed_m_per_s) {
    return warningsOf({{line + "displacement_m", "[-0.03, 0, 0]"},
                       {line + "speed_m_per_s", speed_m_per_s},
                       {"simulation.duration_s", "2000"}});
  };
  EXPECT_EQ(warningsAt("0.0002"), Warnings{});
  const Warnings warnings = warningsAt("0.00003");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("only the first 300 s of the path were followed, which ends at 100"),
            0u)
      << warnings[0];
}

TEST(PathCheck, WarnsOfObstaclesThatNothingFeels) {
  const std::string free = TACTUS_SOURCE_DIR "/config/scenes/free_motion.yaml";
  const std::vector<Override> obstacle = {
      {"simulation.obstacles", "[{x_m: 0.6, y_m: 0.0, stiffness_N_per_m: 300}]"}};
  EXPECT_EQ(checkPath(loadScene(free, {})), Warnings{});
  EXPECT_EQ(checkPath(loadScene(free, obstacle)),
            Warnings{"nothing feels the obstacles: there is no controller"});
}

}  // namespace
}  // namespace tactus
