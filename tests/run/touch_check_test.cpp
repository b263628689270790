#include "tactus/run/touch_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "support/closed_loop.h"
#include "support/scene_files.h"
#include "support/shipped_scene.h"
#include "tactus/control/controller.h"
#include "tactus/control/obstacle_speed.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {
namespace {

using WarningList = std::vector<std::string>;

constexpr double kStiffest_N_per_m = 7000.0;

bool hasWarning(const WarningList& warnings, const std::string& part) {
  return std::ranges::any_of(warnings, [&](const std::string& warning) {
    return warning.find(part) != std::string::npos;
  });
}

ExpectedContact expectedOf(const std::string& name, const std::vector<Override>& settings = {}) {
  return checkContacts(test::shippedScene(name, settings), kStiffest_N_per_m);
}

Override obstacle(const std::string& x_m, const std::string& y_m, const std::string& more = "") {
  return {"simulation.obstacles",
          "[{x_m: " + x_m + ", y_m: " + y_m + ", stiffness_N_per_m: 5000" + more + "}]"};
}

/// When the simulated arm first touches, s, and how hard until 60 ms later.
struct SimulatedTouch {
  double t_s = -1.0, peak_N = 0.0;
};

SimulatedTouch simulateTouch(const Scene& scene) {
  SimulatedTouch touch;
  const Controller controller(scene.controller);
  ControllerState state = controller.initialState();
  SimulatedRobot robot(scene.controller, scene.plant, scene.period_s);
  RobotInput input;
  ControllerOutput output;
  for (double t_s = 0.0; t_s < scene.duration_s; t_s += scene.period_s) {
    robot.read(input);
    controller.update(input, scene.controller.gains, t_s, scene.period_s, state, output);
    robot.write(output.velocity);
    if (touch.t_s < 0.0 && robot.trueForce_N() > 0.0) touch.t_s = t_s;
    if (touch.t_s >= 0.0 && t_s < touch.t_s + 0.06)
      touch.peak_N = std::max(touch.peak_N, robot.trueForce_N());
  }
  return touch;
}

TEST(TouchCheck, HasNothingAgainstTheScenesThatComeAlong) {
  int scenes = 0;
  const std::filesystem::path folder = TACTUS_SOURCE_DIR "/config/scenes";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    const Scene scene = loadScene(entry.path().string(), {});
    EXPECT_EQ(checkContacts(scene, kStiffest_N_per_m).warnings, WarningList{}) << entry.path();
    ++scenes;
  }
  EXPECT_GT(scenes, 20);
}

TEST(TouchCheck, KnowsWhenAndHowHardTheArmTouches) {
  for (const std::string speed : {"0.05", "0.15", "0.4"}) {
    const std::vector<Override> settings{
        {"task.trajectory.line.speed_m_per_s", speed},
        {"simulation.obstacles", "[{x_m: 0.70771, y_m: 0.00265, stiffness_N_per_m: 5000}]"}};
    for (const std::string name : {"scenario1_null_space", "scenario1_multi_space"}) {
      const Scene scene = test::shippedScene(name, settings);
      const ExpectedContact expected = checkContacts(scene, kStiffest_N_per_m);
      ASSERT_EQ(expected.touches.size(), 1u);
      const SimulatedTouch touch = simulateTouch(scene);
      EXPECT_NEAR(expected.touches[0].touch.t_s, touch.t_s, 0.012) << "the drives lag behind";
      EXPECT_NEAR(expected.touches[0].peak_N, touch.peak_N, 0.25 * touch.peak_N) << name << speed;
    }
  }
}

/// Simulated, joint space comes to 3.1 N with F_eng of 0 and to 50 N with 50 N; null_task gives way
/// with its second space all the same.
TEST(TouchCheck, KnowsAFeedforwardThatEngagesWithTheForce) {
  const auto peak_N = [](const char* variant, const char* engage_force_N) {
    const ExpectedContact expected =
        expectedOf("scenario3_assumed", {obstacle("0.65413", "0.06351"),
                                         {"task.trajectory.line.speed_m_per_s", "0.03"},
                                         {"controller.variant", variant},
                                         {"controller.transition.engage_force_N", engage_force_N}});
    return expected.touches.empty() ? 0.0 : expected.touches.front().peak_N;
  };
  EXPECT_LT(peak_N("joint_space", "0"), 5.0);
  EXPECT_GT(peak_N("joint_space", "50"), 45.0);
  EXPECT_GT(peak_N("null_task", "0"), 0.0);
  EXPECT_EQ(peak_N("null_task", "50"), peak_N("null_task", "0"));
}

TEST(TouchCheck, NamesASpeedThatKeepsTheForceOfTheLaw) {
  const std::vector<Override> fast{{"task.trajectory.line.speed_m_per_s", "0.3"},
                                   obstacle("0.70771", "0.00265")};
  const ExpectedContact expected = expectedOf("scenario1_multi_space", fast);
  ASSERT_EQ(expected.touches.size(), 1u);
  ASSERT_TRUE(expected.touches[0].softer);
  const SofterTouch& softer = *expected.touches[0].softer;
  EXPECT_NEAR(softer.force_N, 5.0, 1e-12);
  EXPECT_GT(expected.touches[0].peak_N, 5.0);
  EXPECT_LT(softer.speed_m_per_s, expected.touches[0].touch.speed_m_per_s);
  EXPECT_GT(softer.speed_m_per_s, 0.0);
}

TEST(TouchCheck, HasMassesOnlyOfRobotsThatSayThem) {
  const ExpectedContact with = expectedOf("scenario1_null_space");
  ASSERT_TRUE(with.peak && with.peak->mass_kg);
  EXPECT_GT(*with.peak->mass_kg, 1.0);
  EXPECT_LT(*with.peak->mass_kg, 40.0);
  const ExpectedContact without = expectedOf("robots/ur5e_contact");
  ASSERT_TRUE(without.peak);
  EXPECT_FALSE(without.peak->mass_kg);
  EXPECT_EQ(without.peak->peak_N(), without.peak->delay_peak_N);
}

/// Both bounds grow with the speed; a slower path has its fastest place elsewhere.
TEST(TouchCheck, KeepsBelowTheForceOfTheLawAtTheSpeedItNames) {
  const std::string key = "task.trajectory.line.speed_m_per_s";
  const ExpectedContact fast = expectedOf("scenario3_tactus", {{key, "0.2"}});
  ASSERT_TRUE(fast.peak);
  EXPECT_EQ(fast.peak->target_N, 5.0);
  EXPECT_GT(fast.peak->peak_N(), 5.0);
  const double share = fast.peak->target_speed_m_per_s / fast.peak->fastest.speed_m_per_s;
  const ExpectedContact slow = expectedOf("scenario3_tactus", {{key, std::to_string(0.2 * share)}});
  EXPECT_NEAR(slow.peak->peak_N(), 5.0, 0.75);
}

/// The force at the end of a scene whose obstacles move all the time, that fast.
double forceWithMotion(Scene scene, const Vector3& velocity) {
  constexpr double kSlow_hz = 0.003;  // so that the speed stays within 2 %
  const Vector3 amplitude = velocity / (2.0 * std::numbers::pi * kSlow_hz);
  for (ObstacleConfig& obstacle : scene.plant.obstacles) {
    obstacle.swing = {amplitude.x(), amplitude.y(), kSlow_hz};
    // At its place when the arm is there.
    obstacle.x_m -= scene.duration_s * velocity.x();
    obstacle.y_m -= scene.duration_s * velocity.y();
  }
  test::ClosedLoop loop(scene.controller, scene.plant, scene.period_s);
  while (loop.time_s() < scene.duration_s) loop.step();
  return loop.robot().trueForce_N();
}

/// From all sides, against a law that knows the stiffness.
TEST(TouchCheck, SaysHowFastAnObstacleMayMove) {
  EXPECT_FALSE(expectedOf("scenario1_null_space").moving);
  const ExpectedContact expected = expectedOf("scenario3_tactus");
  ASSERT_TRUE(expected.moving);
  const MovingObstacle& moving = *expected.moving;
  EXPECT_NEAR(moving.force_N, 7.5, 1e-12);
  Scene scene = test::shippedScene("scenario3_tactus");
  scene.controller.force_control->has_estimator = false;
  const auto restsAt_N = [&](double stiffness_N_per_m) {
    scene.controller.gains.force.assumed_stiffness_N_per_m = stiffness_N_per_m;
    const double speed = moving.speed_m_per_s * moving.stiffness_N_per_m / stiffness_N_per_m;
    double largest_N = 0.0;
    for (int i = 0; i < 16; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 16.0;
      const Vector3 velocity = speed * Vector3(std::cos(angle), std::sin(angle), 0.0);
      largest_N = std::max(largest_N, forceWithMotion(scene, velocity));
    }
    return largest_N;
  };
  EXPECT_NEAR(restsAt_N(1.2 * kSoftContact_N_per_m), moving.force_N, 0.1 * moving.force_N);
  ASSERT_LT(moving.stiffness_N_per_m, kSoftContact_N_per_m);
  EXPECT_LT(restsAt_N(moving.stiffness_N_per_m), 0.85 * moving.force_N)
      << "the law finds how fast a soft one comes";
}

TEST(TouchCheck, WarnsOfObstaclesThatNothingTouches) {
  EXPECT_EQ(expectedOf("scenario1_null_space", {obstacle("-2", "-2")}).warnings,
            WarningList{"obstacle 0 is never touched: no cover comes to it on the scene's path"});
}

/// Where an arm is that has given way, its path does not say.
TEST(TouchCheck, SaysNothingOfWhatAppearsWhenTheArmHasGivenWay) {
  const auto warnings = [](const std::string& appears_s, const std::string& variant) {
    return expectedOf("scenario1_null_space",
                      {{"controller.variant", variant},
                       {"simulation.obstacles",
                        "[{x_m: 0.70771, y_m: 0.00265, stiffness_N_per_m: 60}, {x_m: -2, y_m: -2, "
                        "stiffness_N_per_m: 60, appears_s: " +
                            appears_s + "}]"}})
        .warnings;
  };
  const WarningList never{"obstacle 1 is never touched: no cover comes to it on the scene's path"};
  EXPECT_EQ(warnings("12", "null_space"), WarningList{});
  EXPECT_EQ(warnings("0.1", "null_space"), never) << "before anything is touched";
  EXPECT_EQ(warnings("12", "none"), never) << "nothing gives way";
}

TEST(TouchCheck, WarnsOfObstaclesInTheArmAtItsStart) {
  const Scene scene = test::shippedScene("scenario1_null_space");
  ChainPose pose;
  scene.controller.chain.computePose(scene.controller.q_start, pose);
  const Pose X = framePose(pose, scene.controller.tactile_modules[0].link);
  const Vector3 inside = X.p_AB + 0.2 * X.R_AB.col(0);
  const WarningList warnings =
      expectedOf("scenario1_null_space",
                 {obstacle(std::to_string(inside.x()), std::to_string(inside.y()))})
          .warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(
      warnings[0].find("obstacle 0 is touched at the start, 60 mm deep in the cover of link4"),
      std::string::npos)
      << warnings[0];
}

/// Before the arm moves: no speed tells of it.
TEST(TouchCheck, TellsOfWhatAppearsInAnArmThatRests) {
  const Scene scene = test::shippedScene("scenario1_null_space");
  ChainPose pose;
  scene.controller.chain.computePose(scene.controller.q_start, pose);
  const Pose X = framePose(pose, scene.controller.tactile_modules[0].link);
  const Vector3 side = Vector3::UnitZ().cross(X.R_AB.col(0)).normalized();
  const auto expected = [&](double depth_m) {  // in the side of the cover
    const Vector3 p = X.p_AB + 0.2 * X.R_AB.col(0) + (0.06 - depth_m) * side;
    return expectedOf("scenario1_null_space",
                      {{"redundancy", "~"},  // which would move it a little
                       obstacle(std::to_string(p.x()), std::to_string(p.y()), ", appears_s: 0.2")});
  };
  const ExpectedContact deep = expected(0.05);
  ASSERT_EQ(deep.touches.size(), 1u);
  EXPECT_EQ(deep.touches[0].touch.speed_m_per_s, 0.0);
  const double both_N_per_m = 1.0 / (1.0 / 5000.0 + 1.0 / 7000.0);
  EXPECT_NEAR(deep.touches[0].peak_N, both_N_per_m * 0.05, 1.0);
  EXPECT_FALSE(deep.touches[0].softer);
  EXPECT_TRUE(hasWarning(deep.warnings, "the touch of obstacle 0 may come to 14"))
      << "the sensor shows 100 N";
  EXPECT_TRUE(expected(0.0003).touches.empty()) << "below the contact's threshold";
}

TEST(TouchCheck, WarnsOfMoreFrictionThanTheLawBears) {
  const auto warns = [](const std::string& name, const std::string& of_obstacle,
                        const std::string& of_law) {
    const Override there{"simulation.obstacles[0].friction_coefficient", of_obstacle};
    const auto warnings =
        expectedOf(name, {there, {"controller.friction_coefficient", of_law}}).warnings;
    return hasWarning(warnings, "obstacle 0 has a friction of " + of_obstacle);
  };
  EXPECT_TRUE(warns("scenario3_tactus", "0.3", "0"));
  EXPECT_TRUE(warns("scenario3_tactus", "0.3", "0.3"));
  EXPECT_FALSE(warns("scenario3_tactus", "0.3", "0.31"));
  EXPECT_FALSE(warns("scenario3_tactus", "0", "0"));
  EXPECT_TRUE(warns("scenario3_estimated", "0.1", "0")) << "no law of the paper bears any";
  EXPECT_FALSE(warns("real/real_scenario3_mx", "0.3", "0")) << "the module tells the normal";
}

TEST(TouchCheck, WarnsOfAPeakThatTheSensorCannotShow) {
  EXPECT_TRUE(hasWarning(
      expectedOf("scenario1_null_space", {{"robot.tactile_module.max_force_N", "3"}}).warnings,
      "the sensor's max_force_N is 3"));
}

/// A scene that simulates quicker drives or filters says nothing of the arm that tactusd moves.
TEST(TouchCheck, ExpectsThePeakOfTheDaemonsArmAndTheTouchesOfTheSimulated) {
  const std::string name = "scenario1_null_space";
  const ExpectedContact plain = expectedOf(name);
  for (const Override& quicker : {Override{"simulation.drive_lag_s", "0"},
                                  Override{"simulation.tactile_module.filter_cutoff_hz", "40"}}) {
    const ExpectedContact quick = expectedOf(name, {quicker});
    EXPECT_EQ(quick.peak->delay_s, plain.peak->delay_s) << quicker.key;
    EXPECT_LT(quick.touches.at(0).peak_N, plain.touches.at(0).peak_N) << quicker.key;
  }
  const ExpectedContact slow = expectedOf(name, {{"simulation.drive_lag_s", "0.02"}});
  EXPECT_GT(slow.peak->delay_s, plain.peak->delay_s + 0.014);
}

TEST(TouchCheck, TellsHowMuchOfALongRunItSearched) {
  const auto warnings = [](const std::string& duration_s) {
    return expectedOf("scenario1_null_space", {{"simulation.duration_s", duration_s}}).warnings;
  };
  EXPECT_EQ(warnings("300"), WarningList{});
  EXPECT_EQ(warnings("300.5"),
            WarningList{"only the first 300 s of the run were searched for touches"});
}

/// 148 N with as many counts as it has, by hand in channel_range_test.cpp.
TEST(TouchCheck, TakesTheFirstChannelsEndForThatOfTheSensor) {
  const auto peakWith = [](const std::string& counts_per_N) {
    return expectedOf("scenario1_null_space",
                      {{"robot.tactile_module.counts_per_N", counts_per_N}});
  };
  EXPECT_EQ(peakWith("1e5").peak->sensor_N, 100.0) << "its max_force_N";
  const ExpectedContact finer = peakWith("5e6");
  EXPECT_NEAR(finer.peak->sensor_N, 2.961, 0.001);
  EXPECT_EQ(finer.peak->target_N, finer.peak->sensor_N) << "a law without F_act";
  EXPECT_TRUE(hasWarning(finer.warnings, "N, a channel of the sensor is at its end at 2.96 N: "));
}

/// It comes in over the end of the cover, 19 mm deep: no speed makes that softer.
TEST(TouchCheck, WarnsOfATouchThatTheSensorCannotShow) {
  const ExpectedContact expected =
      expectedOf("scenario2_tactus", {{"simulation.obstacles[0].x_m", "0.745"},
                                      {"simulation.obstacles[0].stiffness_N_per_m", "1e5"}});
  ASSERT_EQ(expected.touches.size(), 2u);
  EXPECT_GT(expected.touches[0].peak_N, 100.0);
  EXPECT_FALSE(expected.touches[0].softer);
  EXPECT_TRUE(expected.touches[1].peak_N < 5.0 || expected.touches[1].softer);
  ASSERT_EQ(expected.warnings.size(), 1u);
  EXPECT_NE(expected.warnings[0].find("the touch of obstacle 0 may come to 1"), std::string::npos)
      << expected.warnings[0];
  EXPECT_TRUE(hasWarning(expected.warnings, "the sensor's max_force_N is 100"));
}

/// The mass that a contact is said to meet, of an arm that is told where to go.
double massOfTold(const test::SceneFiles& files, const std::string& rotors) {
  const Scene scene = files.load({{"task.trajectory", "~"},
                                  {"task.source", "commands"},
                                  {"task.wait_beyond_m", "0.02"},
                                  {"task.max_return_speed_m_per_s", "0.05"},
                                  {"robot.dynamics", "{rotor_inertia: " + rotors + "}"}});
  const ExpectedContact expected = checkContacts(scene, kStiffest_N_per_m);
  EXPECT_TRUE(expected.peak && expected.peak->mass_kg);
  EXPECT_EQ(expected.peak->fastest.speed_m_per_s, 0.1);
  return expected.peak->mass_kg.value_or(0.0);
}

/// However a module is turned about its link. Its middle is 0.25 m from the shoulder's axis.
TEST(TouchCheck, MassOfAnArmThatIsToldIsThatOfWaysThatItHas) {
  for (const char* const roll : {"0", "0.4", "1.5707963267948966", "1.5707963", "-2.2"}) {
    test::SceneFiles files;
    files.urdf = test::replaced(files.urdf, "<origin xyz=\"0.05 0 0\"/>",
                                std::string("<origin xyz=\"0.05 0 0\" rpy=\"") + roll + " 0 0\"/>");
    EXPECT_NEAR(massOfTold(files, "[9, 0.5, 0.1]"), 9.0, 1e-6) << roll;  // the lift's
    EXPECT_NEAR(massOfTold(files, "[7, 0.5, 0.1]"), 8.0, 1e-6) << roll;  // the shoulder's
    files.urdf = test::replaced(files.urdf, "axis xyz=\"0 0 2\"", "axis xyz=\"2 0 0\"");
    const double lift = std::sin(0.2);
    EXPECT_NEAR(massOfTold(files, "[9, 0.5, 0.1]"), 1.0 / (lift * lift / 9.0 + 0.25 * 0.25 / 0.5),
                1e-6)
        << "in a plane alone, " << roll;
  }
}

/// Speeds of zero, and paths that never end, are no numbers to divide by.
TEST(TouchCheck, StandsAnArmThatHolds) {
  const ExpectedContact held = expectedOf(
      "scenario1_null_space",
      {{"task.trajectory", "{hold: {}}"}, {"task.trajectory.line", "~"}, obstacle("-2", "-2")});
  EXPECT_TRUE(held.touches.empty());
  ASSERT_TRUE(!held.peak || std::isfinite(held.peak->peak_N()));
}

}  // namespace
}  // namespace tactus
