#include "tactus/control/contact_transition.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/period.h"

namespace tactus {
namespace {

using test::kPeriod_s;
const Vector3 kLost(0.3, -0.2, 1.1);

class Transition : public testing::Test {
 protected:
  /// Contact at kLost, then `cycles` without contact at `distance_m` from there. Returns the
  /// product of the integral's decays.
  double loseContact(double distance_m, int cycles) {
    passTransition(gains_, 5.0, kLost, kPeriod_s, state_);
    double decay = 1.0;
    for (int i = 0; i < cycles; ++i)
      decay *=
          passTransition(gains_, 0.0, kLost + Vector3(0.0, distance_m, 0.0), kPeriod_s, state_);
    return decay;
  }

  ContactTransitionGains gains_;
  ContactTransitionState state_;
};

TEST_F(Transition, HasNoFeedforwardBeforeTheFirstContact) {
  for (int i = 0; i < 100; ++i) passTransition(gains_, 0.0, kLost, kPeriod_s, state_);
  EXPECT_EQ(state_.gamma, 0.0);
}

TEST_F(Transition, EngagesAtOnceByDefault) {
  EXPECT_EQ(passTransition(gains_, 1e-6, kLost, kPeriod_s, state_), 1.0) << "the integral stays";
  EXPECT_EQ(state_.gamma, 1.0);
}

TEST_F(Transition, EngagesOverItsForceRangeAndNeverBackwards) {
  gains_.engage_force_N = 0.5;
  passTransition(gains_, 0.1, kLost, kPeriod_s, state_);
  EXPECT_DOUBLE_EQ(state_.gamma, 0.2);
  passTransition(gains_, 0.3, kLost, kPeriod_s, state_);
  EXPECT_DOUBLE_EQ(state_.gamma, 0.6);
  passTransition(gains_, 0.2, kLost, kPeriod_s, state_);
  EXPECT_DOUBLE_EQ(state_.gamma, 0.6) << "less force is no reason to push again";
  passTransition(gains_, 0.7, kLost, kPeriod_s, state_);
  EXPECT_EQ(state_.gamma, 1.0);
}

TEST_F(Transition, KeepsTheFeedforwardWhereContactWasLost) {
  const double decay = loseContact(0.0, 5000);
  EXPECT_DOUBLE_EQ(state_.gamma, 1.0);
  EXPECT_NEAR(decay, std::exp(-5.0), 1e-9) << "V leaks with T_t,max = 1 s";
}

TEST_F(Transition, FadesWithTheDistance) {
  // delta = d_t / 2: g = 1/2, T_t = 0.5 s; after 0.5 s: gamma = 1/2 + 1/2 / e.
  const double decay = loseContact(0.025, 500);
  EXPECT_NEAR(state_.gamma, 0.5 + 0.5 * std::exp(-1.0), 1e-9);
  EXPECT_NEAR(decay, std::exp(-1.0), 1e-9);
}

TEST_F(Transition, EndsBeyondItsDistance) {
  for (const double distance_m : {0.05 + 1e-9, 0.0501, 3.0}) {
    EXPECT_EQ(loseContact(distance_m, 1), 0.0) << "the integral is gone";
    EXPECT_EQ(state_.gamma, 0.0);
  }
}

TEST_F(Transition, ChangesLittleFromCycleToCycleOnTheWayOut) {
  passTransition(gains_, 5.0, kLost, kPeriod_s, state_);
  double before = state_.gamma;
  for (int i = 0; i <= 1000; ++i) {  // 0.06 m in 1 s
    passTransition(gains_, 0.0, kLost + Vector3(6e-5 * i, 0.0, 0.0), kPeriod_s, state_);
    ASSERT_LE(state_.gamma, before + 1e-15);
    ASSERT_LT(before - state_.gamma, 0.02) << "at step " << i;
    before = state_.gamma;
  }
  EXPECT_EQ(state_.gamma, 0.0);
}

TEST_F(Transition, MeasuresFromTheLastContact) {
  loseContact(3.0, 10);
  const Vector3 elsewhere = kLost + Vector3(1.0, 0.0, 0.0);
  passTransition(gains_, 2.0, elsewhere, kPeriod_s, state_);
  passTransition(gains_, 0.0, elsewhere, kPeriod_s, state_);
  EXPECT_DOUBLE_EQ(state_.gamma, 1.0);
}

}  // namespace
}  // namespace tactus
