#include <gtest/gtest.h>

#include "support/controller_run.h"
#include "support/crops9.h"

/// Something soft that came towards an arm, which then was held for long.
namespace tactus {
namespace {

constexpr double kPlace_m = 0.2, kPressedAt_rad = 2.8;

struct FollowedArm {
  ControllerConfig config;
  Controller controller;
  ControllerState state;
  ControllerOutput output;
  RobotInput input;
  Vector3 p_BaseStart, away;
  double stiffness_N_per_m, obstacle_m = 0.0, force_N = 0.0;
  long cycle = 0;

  FollowedArm(const ControllerConfig& c, double stiffness)
      : config(c), controller(c), state(controller.initialState()), stiffness_N_per_m(stiffness) {
    p_BaseStart = contact().p_Base;
    away = contact().F_Base;
  }

  PlacedContact contact() const {
    const ContactPointState point{
        .position_m = kPlace_m,
        .direction = Vector3(0.0, std::cos(kPressedAt_rad), std::sin(kPressedAt_rad))};
    ChainPose pose;
    config.chain.computePose(state.q_desired, pose);
    return placed(pose, config.tactile_modules.front().link, point);
  }

  void step(double v_obstacle_m_per_s) {
    obstacle_m += 1e-3 * v_obstacle_m_per_s;
    const double pressed_m = obstacle_m - (contact().p_Base - p_BaseStart).dot(away);
    force_N = std::clamp(stiffness_N_per_m * pressed_m, 0.0, 90.0);
    input.q_measured = state.q_desired;
    if (cycle++ % 4 == 0)
      input.tactile[0] =
          test::touchAt(kPlace_m, force_N, kPressedAt_rad, input.tactile[0].sequence + 1);
    controller.update(input, config.gains, 0.0, 1e-3, state, output);
  }

  const ApproachLimitState& approach() const {
    return config.force_control->limit_at == LimitAt::kResultant
               ? state.contact.approach
               : state.several.modules.front().approach;
  }
};

ControllerConfig followedConfig(LimitAt limit_at, double stiffness_N_per_m) {
  ControllerConfig config = test::crops9Controller(Variant::kNullLimit);
  config.task.trajectory.waypoints.clear();
  config.gains.force.assumed_stiffness_N_per_m = stiffness_N_per_m;
  config.force_control->limit_at = limit_at;
  config.limits.lower.setConstant(-3.0);
  config.limits.upper.setConstant(3.0);
  return config;
}

/// Whatever it was that came, it may have stopped since.
TEST(HeldObstacle, ItsSpeedDoesNotMoveAnArmThatGoesOn) {
  for (const LimitAt limit_at : {LimitAt::kResultant, LimitAt::kStiffnessCentre}) {
    for (const double stiffness_N_per_m : {500.0, 1500.0}) {
      const ControllerConfig config = followedConfig(limit_at, stiffness_N_per_m);
      FollowedArm arm(config, stiffness_N_per_m);
      for (int i = 0; i < 8000; ++i) arm.step(0.02);
      ASSERT_GT(arm.approach().obstacle.v_m_per_s, 0.01) << "nothing to forget";
      arm.state.is_stopping = true;
      for (int i = 0; i < 5000; ++i) arm.step(i < 200 ? 0.02 : 0.0);
      EXPECT_EQ(arm.approach().obstacle.v_m_per_s, 0.0);
      arm.controller.goOn(config.gains, arm.state);
      arm.state.is_stopping = false;
      double least_N = 90.0;
      for (int i = 0; i < 3000; ++i) {
        arm.step(0.0);
        least_N = std::min(least_N, arm.force_N);
      }
      EXPECT_GT(least_N, 4.9) << stiffness_N_per_m << ": gives way too far";
    }
  }
}

}  // namespace
}  // namespace tactus
