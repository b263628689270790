#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/random.h"
#include "support/shipped_scene.h"
#include "tactus/bench/mujoco_robot.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus::physics {
namespace {

constexpr double kStep_s = 0.00003125;

JointVector motorsOf(Robot& robot) {
  RobotInput input;
  robot.read(input);
  return input.q_measured;
}

/// Joints that swing, each with its own frequency from 0.5 to 3 Hz.
struct Swinging {
  Swinging(test::Random& random, int joints)
      : frequency_hz(random.vector(joints, 0.5, 3.0)), share(random.vector(joints, -1.0, 1.0)) {}

  JointVector velocity(double t_s, double speed) const {
    return speed *
           share.cwiseProduct((2.0 * std::numbers::pi * t_s * frequency_hz).array().sin().matrix());
  }

  JointVector frequency_hz, share;
};

/// Largest difference of a motor's way in 0.6 s, m or rad, and the largest lag behind where it
/// was to be: that of an arm without masses would be none.
struct Difference {
  double between = 0.0, lag = 0.0;
};

Difference swing(const Scene& scene, const Swinging& swinging, double speed) {
  // A step more or less of delay is not what is looked for.
  PlantConfig plant = scene.plant;
  plant.dynamics->step_s = kStep_s;
  SimulatedRobot built_in(scene.controller, plant, scene.period_s);
  MujocoRobot mujoco(scene.controller, plant, scene.period_s, kStep_s);
  JointVector q_desired = scene.controller.q_start;
  Difference difference;
  for (int cycle = 0; cycle < 600; ++cycle) {
    const JointVector v = swinging.velocity(0.001 * cycle, speed);
    q_desired += 0.001 * v;
    built_in.write(v);
    mujoco.write(v);
    const JointVector q = motorsOf(built_in);
    difference.between = std::max(difference.between, (q - motorsOf(mujoco)).cwiseAbs().maxCoeff());
    difference.lag = std::max(difference.lag, (q - q_desired).cwiseAbs().maxCoeff());
  }
  EXPECT_TRUE(mujoco.isSound());
  return difference;
}

class ArmMotion : public testing::TestWithParam<const char*> {};

/// What differs is what the built-in plant leaves out, centrifugal forces: next to nothing at the
/// speeds of contact, and some hundred times as much at ten times the speed.
TEST_P(ArmMotion, DiffersFromMujocoByCentrifugalForcesAlone) {
  const Scene scene = test::shippedScene("free_motion", {{"simulation.arm", GetParam()}});
  test::Random random(721);
  const Swinging swinging(random, scene.controller.chain.size());
  const Difference slow = swing(scene, swinging, 0.1);
  const Difference fast = swing(scene, swinging, 1.0);
  EXPECT_GT(slow.lag, 1e-4) << "nothing was compared";
  EXPECT_LT(slow.between, 0.04 * slow.lag);
  EXPECT_GT(fast.between, 20.0 * slow.between);
  EXPECT_LT(fast.between, 0.2 * fast.lag);
}

INSTANTIATE_TEST_SUITE_P(Gears, ArmMotion, testing::Values("rigid_gears", "flexible_gears"));

}  // namespace
}  // namespace tactus::physics
