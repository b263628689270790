#include <gtest/gtest.h>

#include "support/controller_run.h"

/// Work done ahead must not show in what is commanded, whether it was done, left out, or done for
/// another time or state.
namespace tactus {
namespace {

enum class Ahead {
  kRight,
  kNever,
  kWrongTime,
  kBeforeCoasting,
  kOtherTask,
  kOtherLimits,
  kOtherPosture
};

/// The same run, where now and then cycles are missed.
std::vector<ControllerOutput> runAhead(const Controller& controller, std::uint64_t seed,
                                       Ahead ahead) {
  test::Random random(seed);
  test::RandomTouches touches(random);
  ControllerState state = controller.initialState();
  PreparedCycle prepared;
  std::vector<ControllerOutput> outputs(400);
  int cycle = 0;
  for (ControllerOutput& output : outputs) {
    const double t_s = 0.001 * cycle;
    if (ahead == Ahead::kRight) controller.prepare(controller.initialGains(), t_s, state, prepared);
    if (ahead == Ahead::kWrongTime)
      controller.prepare(controller.initialGains(), t_s + 0.001, state, prepared);
    if (ahead == Ahead::kBeforeCoasting)
      controller.prepare(controller.initialGains(), t_s, state, prepared);
    if (ahead >= Ahead::kOtherTask) {
      Gains others = controller.initialGains();
      if (ahead == Ahead::kOtherTask) others.task.drift_gain_per_s *= 0.5;
      if (ahead == Ahead::kOtherLimits) others.joint_limit_avoidance.gain *= 3.0;
      if (ahead == Ahead::kOtherPosture) others.posture.gain_per_s *= 3.0;
      controller.prepare(others, t_s, state, prepared);
    }
    if (cycle % 50 == 49) controller.coast(2, 0.001, state);
    const RobotInput input = touches.next(state.q_desired);
    if (ahead == Ahead::kNever) {
      controller.update(input, controller.initialGains(), t_s, 0.001, state, output);
    } else {
      controller.update(input, controller.initialGains(), t_s, 0.001, prepared, state, output);
    }
    ++cycle;
  }
  return outputs;
}

void expectNoBitChanged(const ControllerConfig& config) {
  const Controller controller(config);
  const std::vector<ControllerOutput> expected = runAhead(controller, 7, Ahead::kNever);
  for (const Ahead ahead : {Ahead::kRight, Ahead::kWrongTime, Ahead::kBeforeCoasting,
                            Ahead::kOtherTask, Ahead::kOtherLimits, Ahead::kOtherPosture}) {
    const std::vector<ControllerOutput> outputs = runAhead(controller, 7, ahead);
    for (std::size_t i = 0; i < outputs.size(); ++i) test::expectSame(outputs[i], expected[i]);
  }
  EXPECT_FALSE(expected.back().velocity.isZero(0.0)) << "at rest everything is the same";
}

TEST(PreparedCycle, ChangesNoBit) {
  test::Random random(101);
  for (const auto& [variant, level] : test::allLaws()) {
    ControllerConfig config = test::fullController(random, random.integer(3, 16), variant, level);
    config.q_posture = JointVector::Constant(config.chain.size(), 0.3);
    expectNoBitChanged(config);
  }
}

TEST(PreparedCycle, IsUsedOnceOnly) {
  test::Random random(102);
  const Controller controller(test::fullController(random, 7, Variant::kNullTask));
  ControllerState state = controller.initialState();
  state.waited_s = 0.25;
  PreparedCycle prepared;
  controller.prepare(controller.initialGains(), 0.5, state, prepared);
  EXPECT_EQ(prepared.path_time_s, 0.25);
  ControllerOutput output;
  controller.update({}, controller.initialGains(), 0.5, 0.001, prepared, state, output);
  EXPECT_NE(prepared.path_time_s, prepared.path_time_s) << "NaN: for no time";
}

}  // namespace
}  // namespace tactus
