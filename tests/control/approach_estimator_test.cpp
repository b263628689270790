#include "tactus/control/approach_estimator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"

namespace tactus {
namespace {

constexpr double kAssumed = 7000.0;
constexpr double kActivation_N = 3.8;
constexpr double kMin_N = 0.2;
constexpr double kSample_s = 0.004;
const double kKappa = 1.0 - std::exp(-kSample_s / 0.03);

ApproachEstimatorState assumedApproach() {
  ApproachEstimatorState state;
  state.stiffness_N_per_m = state.stiffness_raw_N_per_m = kAssumed;
  return state;
}

class ApproachEstimate : public testing::Test {
 protected:
  void touch(double F_p_N, double dx_m) {
    estimateInContact({}, {F_p_N, dx_m, kSample_s, kMin_N, is_limiting_}, state_);
  }
  /// Ten samples of such a way each, then 4 N more.
  void push(double dx_m) {
    state_.F_ref_N = 3.0;
    for (int i = 0; i < 9; ++i) touch(3.0, dx_m);
    touch(7.0, dx_m);
  }
  double c() const { return state_.stiffness_N_per_m; }

  bool is_limiting_ = false;
  ApproachEstimatorState state_ = assumedApproach();
};

TEST_F(ApproachEstimate, RisesAtOnce) {
  touch(0.1, 1e-6);
  EXPECT_EQ(c(), kAssumed) << "no change of force that means anything";
  touch(3.0, 99e-6);  // 3 N over 0.1 mm
  EXPECT_NEAR(c(), 3e4, 1e-8);
  EXPECT_EQ(state_.x_m, 0.0) << "re-armed";
  EXPECT_EQ(state_.F_ref_N, 3.0);
}

TEST_F(ApproachEstimate, FallsSlowlyFarFromTheActivationForce) {
  touch(0.5, 1e-3);  // 500 N/m
  EXPECT_NEAR(c(), kAssumed + kKappa * (500.0 - kAssumed), 1e-9);
  EXPECT_EQ(state_.stiffness_raw_N_per_m, 500.0);
}

TEST_F(ApproachEstimate, DoesNotFallWhileLoadedNearTheActivationForce) {
  touch(0.5 * kActivation_N, 1e-3);
  EXPECT_EQ(c(), kAssumed);
  EXPECT_EQ(state_.F_ref_N, 0.5 * kActivation_N) << "re-armed all the same";
}

TEST_F(ApproachEstimate, AWayWithoutForceIsAnUpperBound) {
  touch(0.05, 0.01);  // at most (0.05 + 0.2) N over 10 mm
  EXPECT_NEAR(c(), kAssumed + kKappa * (25.0 - kAssumed), 1e-9);
  touch(0.05, 0.01);  // x goes on
  EXPECT_NEAR(state_.stiffness_raw_N_per_m, 12.5, 1e-9);
}

TEST_F(ApproachEstimate, AShortWayCountsAsTheShortestKnown) {
  touch(1.0, 1e-9);  // 1 N over 50 um
  EXPECT_NEAR(c(), 2e4, 1e-8);
  EXPECT_EQ(state_.F_ref_N, 0.0) << "not re-armed: the way is still too short";
  touch(0.5, 1e-9);
  EXPECT_NEAR(c(), 2e4, 1e-8) << "1e4 is a lower bound only";
}

TEST_F(ApproachEstimate, ASlowWayCountsAsLongerWhileTheArmIsHeldBack) {
  is_limiting_ = true;
  push(2e-5);  // 0.2 mm in 40 ms, at half of v_s
  EXPECT_NEAR(c(), 4.0 / 4e-4, 1e-8);
  EXPECT_EQ(state_.limited_s, 0.0) << "re-armed";
  push(1e-5);  // slower, but no more than four times as long
  EXPECT_NEAR(c(), 4.0 / 4e-4, 1e-8);
  push(0.6e-5);
  EXPECT_NEAR(c(), 4.0 / 2.4e-4, 1e-8);
}

/// 4 N over 2 mm are 2000 N/m, whatever a way four times as long would say: that is harmless.
TEST_F(ApproachEstimate, ASlowWayRaisesNoLessThanToWhatIsHarmless) {
  state_.stiffness_N_per_m = 1000.0;
  is_limiting_ = true;
  for (int i = 0; i < 200; ++i) touch(3.0, 0.0);
  push(2e-4);
  EXPECT_NEAR(c(), 2000.0, 1e-8);
  state_.stiffness_N_per_m = 1000.0;
  for (int i = 0; i < 200; ++i) touch(3.0, 0.0);
  push(1e-4);  // 4000 N/m, or 1000
  EXPECT_NEAR(c(), 2500.0, 1e-8);
}

TEST_F(ApproachEstimate, AFastWayIsTakenAsItIs) {
  is_limiting_ = true;
  push(4.4e-5);  // 11 mm/s
  EXPECT_NEAR(c(), 4.0 / 4.4e-4, 1e-8);
}

TEST_F(ApproachEstimate, ASlowWayIsTakenAsItIsWhereNothingHoldsTheArmBack) {
  push(1e-5);
  EXPECT_NEAR(c(), 4.0 / 1e-4, 1e-8);
}

TEST_F(ApproachEstimate, ASlowWayIsTakenAsItIsOnceTheContactIsStiff) {
  state_.stiffness_N_per_m = 21e3;
  is_limiting_ = true;
  push(1e-5);
  EXPECT_NEAR(c(), 4.0 / 1e-4, 1e-8);
}

TEST_F(ApproachEstimate, UnloadingTellsTheStiffnessToo) {
  touch(3.0, 1e-3);  // 3000 N/m, but near F_act: c stays
  ASSERT_EQ(c(), kAssumed);
  touch(2.5, -1e-3);  // turned: from 3 N on, -0.5 N over -1 mm
  EXPECT_NEAR(state_.stiffness_raw_N_per_m, 500.0, 1e-9);
  EXPECT_NEAR(c(), kAssumed + kKappa * (500.0 - kAssumed), 1e-9);
}

/// Else every sample of the way back would be one more quotient of the same change.
TEST_F(ApproachEstimate, UnloadingCountsFromWhereItWasLastLearntOf) {
  touch(3.0, 1e-3);
  touch(2.5, -1e-3);
  EXPECT_EQ(state_.F_ref_N, 2.5);
  EXPECT_EQ(state_.x_m, 0.0);
  const double before = c();
  touch(2.4, -1e-4);
  EXPECT_EQ(c(), before) << "0.1 N more mean nothing";
}

TEST_F(ApproachEstimate, UnloadingCountsFromWhereTheWayTurned) {
  touch(3.0, 1e-3);
  touch(3.1, 1e-3);  // on, by less than what means anything
  touch(2.6, -1e-3);
  EXPECT_NEAR(state_.stiffness_raw_N_per_m, 500.0, 1e-9) << "0.5 N over 1 mm";
}

TEST_F(ApproachEstimate, AShortWayBackTellsNothing) {
  for (const double way_m : {40e-6, 50e-6}) {
    state_ = assumedApproach();
    touch(3.0, 1e-3);
    touch(2.5, -way_m);
    EXPECT_EQ(state_.stiffness_raw_N_per_m, 3000.0);
    touch(2.5, -20e-6);
    EXPECT_NEAR(state_.stiffness_raw_N_per_m, 0.5 / (way_m + 20e-6), 1e-6) << "together they do";
  }
}

/// As of an obstacle that follows the arm.
TEST_F(ApproachEstimate, ForceThatRisesOnTheWayBackOnlyRearms) {
  touch(3.0, 1e-3);
  touch(3.5, -1e-3);
  EXPECT_EQ(state_.stiffness_raw_N_per_m, 3000.0);
  EXPECT_EQ(state_.F_ref_N, 3.5);
  EXPECT_EQ(state_.x_m, 0.0);
}

TEST_F(ApproachEstimate, AChangeNoLargerThanNoiseIsNone) {
  touch(2.0 * kMin_N, 1e-3);
  const double raw = state_.stiffness_raw_N_per_m;
  touch(kMin_N, -1e-3);
  EXPECT_EQ(state_.stiffness_raw_N_per_m, raw);
  EXPECT_EQ(state_.x_m, -1e-3) << "it goes on";
  state_ = assumedApproach();
  state_.F_ref_N = kMin_N;
  touch(2.0 * kMin_N, -1e-3);
  EXPECT_EQ(state_.F_ref_N, kMin_N);
  state_.x_m = 0.0;
  state_.F_ref_N = 2.0 * kMin_N;
  touch(kMin_N, 1e-3);
  EXPECT_EQ(state_.x_m, 1e-3) << "not re-armed";
  state_ = assumedApproach();
  touch(0.1, 50e-6);
  EXPECT_EQ(state_.stiffness_raw_N_per_m, kAssumed) << "nor is the shortest way long enough";
}

TEST_F(ApproachEstimate, UnloadingNeverRaises) {
  touch(3.0, 1e-3);
  touch(0.5, -51e-6);  // 49 kN/m
  EXPECT_EQ(c(), kAssumed);
}

TEST_F(ApproachEstimate, ForceAgainstTheWayOnlyRearms) {
  touch(3.0, 1e-4);
  const double before = c();
  touch(1.0, 1e-6);  // on, and the force falls
  EXPECT_EQ(c(), before);
  EXPECT_EQ(state_.x_m, 0.0);
  EXPECT_EQ(state_.F_ref_N, 1.0);
}

TEST_F(ApproachEstimate, ForgetsWithoutContact) {
  touch(3.0, 1e-4);
  ASSERT_NEAR(c(), 3e4, 1e-8);
  for (int i = 0; i < 1000; ++i) forgetContact({}, 0.001, state_);
  EXPECT_NEAR(c(), kAssumed + (3e4 - kAssumed) * std::exp(-1.0), 1e-6);
  EXPECT_EQ(state_.stiffness_raw_N_per_m, c());
  EXPECT_EQ(state_.x_m, 0.0);
  EXPECT_EQ(state_.F_ref_N, 0.0);
  EXPECT_EQ(state_.F_before_N, 0.0);
}

TEST_F(ApproachEstimate, BeginsAnewBelowTheThresholdWithWhatItKnows) {
  touch(3.0, 1e-4);
  touch(3.1, 1e-5);
  forgetContact({}, 0.0, state_);
  EXPECT_NEAR(c(), 3e4, 1e-8);
  EXPECT_EQ(state_.x_m, 0.0);
  EXPECT_EQ(state_.F_ref_N, 0.0);
  EXPECT_EQ(state_.F_before_N, 0.0);
}

TEST_F(ApproachEstimate, FindsSpringsSofterAndStiffer) {
  for (const double stiffness : {30.0, 600.0, 2e4, 3e5}) {
    state_ = assumedApproach();
    // To 1.5 N within 300 samples, below F_act / 2.
    const double dx_m = 1.5 / stiffness / 300.0;
    double way_m = 0.0;
    for (int i = 0; i < 300; ++i) touch(stiffness * (way_m += dx_m), dx_m);
    const double known = std::min(stiffness, 1.5 / 50e-6);
    EXPECT_GT(c(), 0.95 * known) << stiffness;
    EXPECT_LT(c(), 1.7 * known) << stiffness << ", an upper bound while nothing is felt";
  }
}

TEST_F(ApproachEstimate, StaysInRangeWhateverComes) {
  test::Random random(321);
  for (int i = 0; i < 100000; ++i) {
    if (random.chance(0.1)) forgetContact({}, random.logUniform(1e-9, 1e9), state_);
    touch(random.logUniform(1e-9, 1e9), random.sign() * random.logUniform(1e-12, 1e6));
    ASSERT_GE(c(), 10.0);
    ASSERT_LE(c(), 1e6);
    ASSERT_TRUE(std::isfinite(state_.x_m + state_.F_ref_N));
  }
}

}  // namespace
}  // namespace tactus
