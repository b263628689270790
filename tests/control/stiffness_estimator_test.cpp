#include "tactus/control/stiffness_estimator.h"

#include <gtest/gtest.h>

#include "support/period.h"
#include "support/random.h"

/// Algorithm 1 by hand, with all that the paper leaves open.
namespace tactus {
namespace {

using test::kPeriod_s;
constexpr double kFirstGuess = 7000.0;

StiffnessEstimatorState assumed() {
  StiffnessEstimatorState state;
  state.stiffness_N_per_m = state.stiffness_raw_N_per_m = kFirstGuess;
  return state;
}

class Estimator : public testing::Test {
 protected:
  void update(double F_p_N, double approach_m_per_s) {
    estimateStiffness({}, F_p_N, approach_m_per_s, kPeriod_s, state_);
  }

  StiffnessEstimatorState state_ = assumed();
};

const double kPart = 1.0 - std::exp(-kPeriod_s / 0.03);

TEST_F(Estimator, StartsAtTheAssumedStiffness) {
  EXPECT_EQ(state_.stiffness_N_per_m, kFirstGuess);
  EXPECT_EQ(state_.stiffness_raw_N_per_m, kFirstGuess) << "not zero: the filter would pull c down";
  update(0.1, 0.05);
  EXPECT_EQ(state_.stiffness_N_per_m, kFirstGuess);
}

TEST_F(Estimator, FollowsAlgorithm1ByHand) {
  update(0.1, 0.04);  // x = (0.04 + 0) / 2 ms = 2e-5, F rises by 0.1: no trigger
  EXPECT_DOUBLE_EQ(state_.x_int_m, 2e-5);
  EXPECT_EQ(state_.F_prev_N, 0.0);
  update(0.2, 0.04);  // x = 6e-5, F rises by exactly F_est,min: not above
  EXPECT_DOUBLE_EQ(state_.x_int_m, 6e-5);
  update(0.3, 0.06);  // x = 1.1e-4, F rises by 0.3: c_raw = 0.3 / 1.1e-4
  EXPECT_NEAR(state_.stiffness_raw_N_per_m, 0.3 / 1.1e-4, 1e-9);
  EXPECT_EQ(state_.x_int_m, 0.0);
  EXPECT_EQ(state_.F_prev_N, 0.3);
  EXPECT_EQ(state_.v_prev_m_per_s, 0.06);
  const double c = kFirstGuess + kPart * (0.3 / 1.1e-4 - kFirstGuess);
  EXPECT_NEAR(state_.stiffness_N_per_m, c, 1e-9) << "the filter sees c_raw in the same cycle";
  update(0.35, 0.02);  // x = 4e-5; filter goes on
  EXPECT_DOUBLE_EQ(state_.x_int_m, 4e-5);
  EXPECT_NEAR(state_.stiffness_N_per_m, c + kPart * (0.3 / 1.1e-4 - c), 1e-9);
}

TEST_F(Estimator, ATriggerWithoutWayGivesNoEstimateButReArms) {
  update(1.0, 0.001);  // x = 5e-7
  EXPECT_EQ(state_.stiffness_raw_N_per_m, kFirstGuess);
  EXPECT_EQ(state_.F_prev_N, 1.0);
  EXPECT_EQ(state_.x_int_m, 0.0);
  EXPECT_EQ(state_.stiffness_N_per_m, kFirstGuess);
}

TEST_F(Estimator, FreezesAndRestartsWhileThePointDoesNotApproach) {
  for (int i = 1; i < 20; ++i) update(0.1 * i, 0.05);
  ASSERT_NE(state_.stiffness_N_per_m, state_.stiffness_raw_N_per_m);
  for (const double v : {0.0, -0.03}) {
    const StiffnessEstimatorState before = state_;
    update(5.0, v);
    EXPECT_EQ(state_.stiffness_N_per_m, before.stiffness_N_per_m);
    EXPECT_EQ(state_.stiffness_raw_N_per_m, before.stiffness_raw_N_per_m);
    EXPECT_EQ(state_.x_int_m, 0.0);
    EXPECT_EQ(state_.F_prev_N, 5.0) << "a rise of force during a retreat is not counted later";
    EXPECT_EQ(state_.v_prev_m_per_s, v);
  }
}

TEST_F(Estimator, ForgetsAllButTheEstimateAtZeroForce) {
  for (int i = 1; i < 20; ++i) update(0.1 * i, 0.05);
  const double c = state_.stiffness_N_per_m;
  update(0.0, 0.05);
  EXPECT_EQ(state_.stiffness_N_per_m, c);
  EXPECT_EQ(state_.stiffness_raw_N_per_m, c) << "c would creep on towards an old c_raw";
  EXPECT_EQ(state_.x_int_m, 0.0);
  EXPECT_EQ(state_.v_prev_m_per_s, 0.0);
  EXPECT_EQ(state_.F_prev_N, 0.0);
}

TEST_F(Estimator, ClampsTheRawEstimate) {
  update(0.0, 0.0);
  update(50.0, 0.01);  // 50 N over 5e-6 m
  EXPECT_EQ(state_.stiffness_raw_N_per_m, 1e6);
  update(0.0, 0.0);
  for (int i = 0; i < 100; ++i) update(0.0001 * i, 1.0);
  update(0.3, 1.0);  // 0.3 N over 0.1 m
  EXPECT_EQ(state_.stiffness_raw_N_per_m, 10.0);
}

TEST_F(Estimator, FindsTheStiffnessOfASpring) {
  for (const double stiffness : {30.0, 600.0, 17000.0}) {
    state_ = assumed();
    double way_m = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double v = 0.02 + 0.01 * std::sin(0.01 * i);
      update(stiffness * way_m, v);
      way_m += kPeriod_s * v;
    }
    // The force lags the way by one cycle: at most v dt / x of an interval's way.
    EXPECT_NEAR(state_.stiffness_N_per_m, stiffness, 0.02 * stiffness + 1.0);
  }
}

TEST_F(Estimator, FilterIsExactForAnyPeriod) {
  for (const double period_s : {0.00025, 0.004, 0.5}) {
    StiffnessEstimatorState state = assumed();
    state.stiffness_raw_N_per_m = 1000.0;
    const double duration_s = 1.0;
    for (int i = 0; i < std::lround(duration_s / period_s); ++i)
      estimateStiffness({}, 0.1, 1e-9, period_s, state);
    EXPECT_NEAR(state.stiffness_N_per_m, 1000.0 + 6000.0 * std::exp(-duration_s / 0.03), 1e-6);
  }
}

TEST_F(Estimator, StaysInRangeWhateverComes) {
  test::Random random(131);
  for (int i = 0; i < 100000; ++i) {
    update(random.chance(0.3) ? 0.0 : random.logUniform(1e-9, 1e9),
           random.sign() * random.logUniform(1e-12, 1e6));
    ASSERT_GE(state_.stiffness_N_per_m, 10.0);
    ASSERT_LE(state_.stiffness_N_per_m, 1e6);
  }
}

}  // namespace
}  // namespace tactus
