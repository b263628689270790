#include "tactus/control/gains.h"

#include <gtest/gtest.h>

#include "support/controller_run.h"

/// Gains are an input of each cycle: what they were before does not matter, only what they are.
namespace tactus {
namespace {

constexpr int kGainWords = static_cast<int>(sizeof(Gains) / sizeof(double));

double& gainWord(Gains& gains, int i) { return reinterpret_cast<double*>(&gains)[i]; }

/// Return speeds and waiting, too, come and go.
Gains randomGains(test::Random& random) {
  Gains gains;
  for (int i = 0; i < kGainWords; ++i) gainWord(gains, i) *= random.uniform(0.5, 1.0);
  gains.force.transition.engage_force_N = random.chance(0.5) ? 0.0 : 0.5;
  TaskGains& task = gains.task;
  if (random.chance(0.5)) task.max_return_speed_m_per_s = random.logUniform(1e-3, 1.0);
  if (random.chance(0.5)) task.max_return_speed_rad_per_s = random.logUniform(1e-3, 1.0);
  if (random.chance(0.5)) task.wait_beyond_m = random.logUniform(1e-4, 1.0);
  if (random.chance(0.5)) task.wait_beyond_rad = random.logUniform(1e-4, 1.0);
  return gains;
}

/// Drops all that is kept because the gains hardly ever change.
void forgetDerived(ControllerState& state) {
  state.zones = {};
  ContactControllerState& contact = state.contact;
  contact.law.null_speed = {};
  contact.estimator.filter = {};
  contact.joint_space_transition.response = contact.joint_space_transition.fade = {};
  contact.approach.fade = {};
  contact.approach.position.drive_lag = {};
  contact.approach.smoother.ringing = contact.approach.smoother.smoothing = {};
  contact.approach.estimator.filter = contact.approach.estimator.forgetting = {};
}

TEST(Gains, ThatChangeLeaveNothingOfTheOldOnesBehind) {
  test::Random random(401);
  for (const auto& [variant, level] : test::allLaws()) {
    const Controller controller(test::fullController(random, 7, variant, level));
    test::RandomTouches touches(random);
    ControllerState state = controller.initialState();
    Gains gains;
    for (int i = 0; i < 800; ++i) {
      if (random.chance(0.2)) gains = randomGains(random);
      ControllerState forgetful = state;
      forgetDerived(forgetful);
      const RobotInput input = touches.next(state.q_desired);
      ControllerOutput output, expected;
      controller.update(input, gains, 1e-3 * i, 1e-3, state, output);
      controller.update(input, gains, 1e-3 * i, 1e-3, forgetful, expected);
      test::expectSame(output, expected);
      ASSERT_FALSE(HasFailure()) << "cycle " << i;
    }
  }
}

/// Where a controller is after some cycles of a touch, in N, with the default gains.
template <typename Force>
ControllerState stateAfter(const Controller& controller, int cycles, const Force& force_N) {
  ControllerState state = controller.initialState();
  ControllerOutput output;
  for (int i = 0; i < cycles; ++i) {
    const RobotInput input{state.q_desired, test::touchAt(0.2, force_N(i), 0.4, i + 1)};
    controller.update(input, Gains{}, 1e-3 * i, 1e-3, state, output);
  }
  return state;
}

/// Below the threshold the law holds on to the contact that it lost.
TEST(Gains, AReturnSpeedThatComesFindsTheLostContact) {
  test::Random random(403);
  const Controller controller(test::fullController(random, 7, Variant::kNullSpace));
  ControllerState state = stateAfter(controller, 500, [](int i) { return i < 480 ? 8.0 : 0.5; });
  Gains gains;
  ControllerOutput output;
  const RobotInput input{state.q_desired, test::touchAt(0.2, 0.5, 0.4, 500)};
  ControllerState with_speed = state;
  ControllerOutput expected;
  controller.update(input, gains, 0.5, 1e-3, state, expected);
  gains.task.max_return_speed_m_per_s = 1e3;  // far from limiting anything
  controller.update(input, gains, 0.5, 1e-3, with_speed, output);
  EXPECT_GT(expected.contact.gamma, 0.5);
  EXPECT_NEAR(output.contact.gamma, expected.contact.gamma, 1e-3);
  EXPECT_NEAR(output.contact.u_n, expected.contact.u_n, 1e-3 * std::abs(expected.contact.u_n));
}

TEST(Gains, ThatChangeDoSoInTheSameCycle) {
  test::Random random(402);
  const Controller controller(test::fullController(random, 7, Variant::kNullTask));
  const ControllerState state = stateAfter(controller, 700, [](int) { return 8.0; });
  Gains gains;
  ControllerOutput output;
  for (double* const gain : {&gains.task.drift_gain_per_s, &gains.force.time_constant_s,
                             &gains.force.damping, &gains.force.contact_threshold_N,
                             &gains.force.activation_force_N, &gains.joint_limit_avoidance.gain}) {
    const double before = *gain;
    const RobotInput input{state.q_desired, test::touchAt(0.2, 8.0, 0.4, 1000)};
    ControllerState unchanged = state, changed = state;
    ControllerOutput other;
    controller.update(input, gains, 0.7, 1e-3, unchanged, output);
    *gain *= 0.5;
    controller.update(input, gains, 0.7, 1e-3, changed, other);
    EXPECT_NE(output.velocity, other.velocity) << "gain of " << before;
    *gain = before;
  }
}

TEST(Gains, ThatChangedAreNotServedFromAPreparedCycle) {
  test::Random random(403);
  for (const auto& [variant, level] : test::allLaws()) {
    const Controller controller(test::fullController(random, 8, variant, level));
    test::RandomTouches touches(random);
    ControllerState plain = controller.initialState(), ahead = plain;
    PreparedCycle prepared;
    Gains gains;
    for (int i = 0; i < 500; ++i) {
      controller.prepare(gains, 1e-3 * i, ahead, prepared);
      if (random.chance(0.5)) gains = randomGains(random);
      const RobotInput input = touches.next(plain.q_desired);
      ControllerOutput expected, output;
      controller.update(input, gains, 1e-3 * i, 1e-3, plain, expected);
      controller.update(input, gains, 1e-3 * i, 1e-3, prepared, ahead, output);
      test::expectSame(output, expected);
      ASSERT_FALSE(HasFailure()) << "cycle " << i;
    }
  }
}

}  // namespace
}  // namespace tactus
