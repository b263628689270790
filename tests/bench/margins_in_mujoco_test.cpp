#include <gtest/gtest.h>

#include "support/oscillating_contact.h"
#include "tactus/bench/mujoco_robot.h"

namespace tactus::physics {
namespace {

/// With longer steps, for the sake of time.
struct CoarseRobot {
  CoarseRobot(const ControllerConfig& config, const PlantConfig& plant, double period_s)
      : robot(config, plant, period_s, 0.00025) {}
  void read(RobotInput& input) { robot.read(input); }
  void write(const JointVector& velocity) { robot.write(velocity); }
  double trueForce_N() const { return robot.trueForce_N(); }

  MujocoRobot robot;
};

class MarginsInMujoco : public testing::TestWithParam<double> {};

/// What check prints of an arm with flexible gears, where others move that arm.
TEST_P(MarginsInMujoco, AreThoseThatCheckPrints) {
  const test::LoopCase c =
      test::geared({"T", {.order = 1, .time_constant_s = GetParam()}, Variant::kNullSpace});
  const double printed = computeMargins(c.loop, 1.0).largest_stiffness_ratio;
  const double simulated = test::bisectRatio(
      [&](double ratio) { return test::calmsDownOnArm<CoarseRobot>(c, ratio); }, 1.02);
  RecordProperty("printed", std::to_string(printed));
  RecordProperty("simulated", std::to_string(simulated));
  EXPECT_NEAR(simulated, printed, 0.15 * printed);
}

INSTANTIATE_TEST_SUITE_P(TimeConstants, MarginsInMujoco, testing::Values(0.05, 0.1, 0.2));

}  // namespace
}  // namespace tactus::physics
