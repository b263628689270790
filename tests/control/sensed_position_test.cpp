#include "tactus/control/sensed_position.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/period.h"
#include "support/random.h"
#include "tactus/math/filter.h"

/// The position as the force filter sees it, against the simulated module's own filter.
namespace tactus {
namespace {

using test::kPeriod_s;

JointVector joints(double a, double b) { return JointVector{{a, b}}; }

TEST(SensedPosition, IsWhatDrivesAndModuleMakeOfTheCommand) {
  const SensedPosition model(0.005, 15.0);
  ButterworthLowPass module(15.0, 1.0 / kPeriod_s);
  SensedPositionState state;
  test::Random random(301);
  double q = 0.3;
  double arm = 0.0;  // relative to the start
  double filtered = 0.0;
  for (int cycle = 0; cycle < 3000; ++cycle) {
    model.update(joints(q, -2.0 * q), cycle % 4 == 0, kPeriod_s, state);
    arm += lagShare(kPeriod_s, 0.005) * (q - 0.3 - arm);
    filtered = module.update(arm);
    if (cycle % 4 == 0) {
      // Not prewarped: 0.1 % of the cut-off.
      ASSERT_NEAR(state.sensed[0], filtered, 1e-5) << cycle;
      ASSERT_NEAR(state.sensed[1], -2.0 * state.sensed[0], 1e-12);
    }
    q += kPeriod_s * 0.2 * std::sin(0.01 * cycle) + random.uniform(-1e-5, 1e-5);
  }
}

TEST(SensedPosition, ChangesWithSamplesOnly) {
  const SensedPosition model(0.005, 15.0);
  SensedPositionState state;
  model.update(joints(0.0, 0.0), true, kPeriod_s, state);
  for (int cycle = 0; cycle < 20; ++cycle) {
    model.update(joints(0.1, 0.0), false, kPeriod_s, state);
    EXPECT_EQ(state.sensed[0], 0.0);
    EXPECT_EQ(state.commanded[0], 0.1);
  }
  model.update(joints(0.1, 0.0), true, kPeriod_s, state);
  EXPECT_GT(state.sensed[0], 0.01);
  EXPECT_EQ(state.sensed_before[0], 0.0);
}

TEST(SensedPosition, LagsASteadyMotionByDrivesAndFilter) {
  const SensedPosition model(0.005, 15.0);
  for (const double period_s : {0.00025, 0.001, 0.004}) {
    SensedPositionState state;
    double q = 0.0;
    const double v = 0.1;
    for (double t_s = 0.0; t_s < 1.0; t_s += period_s) {
      q += period_s * v;
      model.update(joints(q, 0.0), true, period_s, state);
    }
    const double lag_s = 0.005 + 1.0 / (M_PI * 15.0);
    EXPECT_NEAR(state.commanded[0] - state.sensed[0], v * lag_s, 0.6 * v * period_s) << period_s;
  }
}

TEST(SensedPosition, ComesBackToZeroAndNotToSubnormalNumbers) {
  const SensedPosition model(0.005, 15.0);
  SensedPositionState state;
  model.update(joints(1.0, -1.0), true, kPeriod_s, state);
  for (int cycle = 0; cycle < 100; ++cycle) model.update(joints(1.5, -1.5), true, kPeriod_s, state);
  for (int cycle = 0; cycle < 20000; ++cycle) {
    model.update(joints(1.0, -1.0), true, kPeriod_s, state);
    for (const ScaledVector* fading :
         {&state.lagged, &state.s0, &state.s1, &state.s2, &state.sensed})
      for (const double x : *fading) ASSERT_NE(std::fpclassify(x), FP_SUBNORMAL) << cycle;
  }
  EXPECT_EQ(state.sensed[0], 0.0);
  EXPECT_EQ(state.lagged[0], 0.0);
}

TEST(SensedPosition, DoesNotDriftAtRest) {
  const SensedPosition model(0.005, 15.0);
  SensedPositionState state;
  model.update(joints(1.0, -1.0), true, kPeriod_s, state);
  for (int cycle = 0; cycle < 200000; ++cycle)
    model.update(joints(1.5, -1.0), true, kPeriod_s, state);
  EXPECT_NEAR(state.sensed[0], 0.5, 1e-11);
  EXPECT_EQ(state.sensed[1], 0.0);
}

}  // namespace
}  // namespace tactus
