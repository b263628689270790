#include <gtest/gtest.h>

#include "support/random.h"
#include "support/shipped_scene.h"
#include "tactus/control/controller.h"

namespace tactus {
namespace {

constexpr double kStep_s = 0.01;  ///< some cycles at once

/// How a user brings an arm back to where a scene begins: the tool is told to go where it is in the
/// posture, and the null space does the rest; from anywhere in the joints' ranges.
TEST(HomeScene, BringsAnArmBackToWhereScenesBegin) {
  const Scene scene = test::shippedScene("home");
  const ControllerConfig& config = scene.controller;
  const JointVector& q_home = *config.q_posture;
  const Controller controller(config);
  test::Random random(816);
  for (int i = 0; i < 40; ++i) {
    const JointVector share = random.vector(config.chain.size(), 0.0, 1.0);
    const JointVector q =
        config.limits.lower + share.cwiseProduct(config.limits.upper - config.limits.lower);
    ControllerState state = controller.initialState(q);
    controller.begin(state);
    state.tool_motion =
        state.tool_motion->to(0.0, tipPose(config.chain, q_home), config.task.commands->limits);
    ControllerOutput output;
    const auto away = [&] { return (state.q_desired - q_home).cwiseAbs().maxCoeff(); };
    for (int cycle = 0; cycle < 12'000 && away() > 0.005; ++cycle) {
      RobotInput input;
      input.q_measured = state.q_desired;
      input.tactile[0].sequence = static_cast<std::uint32_t>(cycle + 1);
      controller.update(input, config.gains, cycle * kStep_s, kStep_s, state, output);
      ASSERT_EQ(output.fault, Fault::kNone);
    }
    EXPECT_LE(away(), 0.005) << i;
  }
}

}  // namespace
}  // namespace tactus
