#include "tactus/control/gain_ramp.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>

#include "support/random.h"

namespace tactus {
namespace {

Gains other() {
  Gains gains;
  gains.force.time_constant_s = 0.4;
  gains.force.assumed_stiffness_N_per_m = 70.0;
  gains.force.damping = 1.5;
  gains.task.max_return_speed_m_per_s = 0.1;
  gains.force.estimator.max_N_per_m = 1e4;
  return gains;
}

Gains drawn(test::Random& random) {
  std::array<double, sizeof(Gains) / sizeof(double)> words;
  for (double& word : words) word = random.uniform(0.1, 10.0);
  return std::bit_cast<Gains>(words);
}

/// Drawn, as from + (to - from) is not always to.
TEST(GainRamp, EndsAreTheSetsToTheBit) {
  test::Random random(46);
  for (int i = 0; i < 20; ++i) {
    const Gains from = drawn(random), to = drawn(random);
    EXPECT_TRUE(isSame(gainsBetween(from, to, 0.0), from));
    EXPECT_TRUE(isSame(gainsBetween(from, to, 1.0), to));
    EXPECT_TRUE(isSame(gainsBetween(to, to, 0.3), to));
  }
}

TEST(GainRamp, TimesAndStiffnessesGoInEqualRatios) {
  const Gains half = gainsBetween(Gains{}, other(), 0.5);
  EXPECT_NEAR(half.force.time_constant_s, std::sqrt(0.1 * 0.4), 1e-15);
  EXPECT_NEAR(half.force.assumed_stiffness_N_per_m, std::sqrt(7000.0 * 70.0), 1e-10);
  EXPECT_NEAR(half.force.estimator.max_N_per_m, 1e5, 1e-8);
  EXPECT_NEAR(half.force.damping, 1.0, 1e-15);
  EXPECT_EQ(half.force.contact_threshold_N, Gains{}.force.contact_threshold_N);
}

TEST(GainRamp, OnlyTimesAndStiffnessesGoInRatios) {
  Gains from, to;
  from.force.min_approach_stiffness_N_per_m = 2.0;
  to.force.min_approach_stiffness_N_per_m = 8.0;
  from.force.velocity_gain_per_s = 2.0;
  to.force.velocity_gain_per_s = 8.0;
  from.force.estimator = {2.0, 2.0, 2.0, 2.0};
  to.force.estimator = {8.0, 8.0, 8.0, 8.0};
  const ForceGains half = gainsBetween(from, to, 0.5).force;
  EXPECT_DOUBLE_EQ(half.min_approach_stiffness_N_per_m, 4.0);
  EXPECT_DOUBLE_EQ(half.estimator.filter_time_constant_s, 4.0);
  EXPECT_DOUBLE_EQ(half.estimator.min_N_per_m, 4.0);
  EXPECT_DOUBLE_EQ(half.estimator.min_force_change_N, 5.0);
  EXPECT_DOUBLE_EQ(half.velocity_gain_per_s, 5.0);
}

TEST(GainRamp, WhatIsInfiniteHasNoWay) {
  EXPECT_EQ(gainsBetween(Gains{}, other(), 0.0).task.max_return_speed_m_per_s, kNoLimit);
  EXPECT_EQ(gainsBetween(Gains{}, other(), 0.1).task.max_return_speed_m_per_s, 0.1);
  EXPECT_EQ(gainsBetween(other(), Gains{}, 0.1).task.max_return_speed_m_per_s, kNoLimit);
}

TEST(GainRamp, IsMonotonicAndBetween) {
  const Gains from, to = other();
  double before = from.force.time_constant_s;
  for (int i = 1; i <= 1000; ++i) {
    const double T_s = gainsBetween(from, to, 1e-3 * i).force.time_constant_s;
    ASSERT_GE(T_s, before);
    ASSERT_LE(T_s, to.force.time_constant_s);
    before = T_s;
  }
}

TEST(GainRamp, TakesFiveTimeConstants) {
  EXPECT_EQ(gainRampDuration_s(Gains{}, other()), 2.0);
  EXPECT_EQ(gainRampDuration_s(other(), Gains{}), 2.0);
  Gains quick;
  quick.force.time_constant_s = 0.01;
  EXPECT_EQ(gainRampDuration_s(quick, quick), 0.5);
}

/// The tool that is let go comes back with beta, and shall not be faster than the limit rises.
TEST(GainRamp, RaisesTheActivationForceSlowly) {
  Gains low, high;
  low.force.time_constant_s = high.force.time_constant_s = 0.1;
  low.task.drift_gain_per_s = 4.0;
  high.task.drift_gain_per_s = 2.0;
  low.force.activation_force_N = 3.0;
  high.force.activation_force_N = 5.0;
  EXPECT_EQ(gainRampDuration_s(low, high), 4.0);
  EXPECT_EQ(gainRampDuration_s(high, low), 0.5);
  high.task.drift_gain_per_s = 0.0;
  EXPECT_EQ(gainRampDuration_s(low, high), 10.0);
}

/// There is no ratio to or from zero: it is gone through in equal steps.
TEST(GainRamp, WhatMayBeZeroGoesInSteps) {
  Gains none, some;
  none.force.min_approach_stiffness_N_per_m = 0.0;
  some.force.min_approach_stiffness_N_per_m = 800.0;
  EXPECT_DOUBLE_EQ(gainsBetween(none, some, 0.25).force.min_approach_stiffness_N_per_m, 200.0);
  EXPECT_DOUBLE_EQ(gainsBetween(some, none, 0.25).force.min_approach_stiffness_N_per_m, 600.0);
}

}  // namespace
}  // namespace tactus
