#include "tactus/supervisor/gain_change.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <functional>
#include <numbers>

#include "support/gain_change_rig.h"

namespace tactus {
namespace {

using test::kPeriod_s;

class GainChangeTest : public test::GainChangeRig {};

/// Contact is lost with less than what counts as a swing, which would be told of first.
Gains bouncy() {
  Gains gains;
  gains.force.transition.release_force_N = 1.15;
  return gains;
}

std::function<double(double)> every(double period_s) {
  return [period_s](double t_s) { return std::fmod(t_s, period_s) < 0.5 * period_s ? 1.3 : 1.1; };
}

double swinging(double t_s) { return 5.0 + std::sin(2.0 * std::numbers::pi * 5.0 * t_s); }

TEST_F(GainChangeTest, RampsAndIsKeptAfterItsTrial) {
  change_.order(order(1, 0.2));
  pass(0.5);
  EXPECT_EQ(state(), GainState::kRamping);
  EXPECT_NEAR(T_s(), std::sqrt(0.1 * 0.2), 1e-3);
  pass(0.6);
  EXPECT_EQ(state(), GainState::kOnTrial);
  EXPECT_EQ(T_s(), 0.2);
  EXPECT_EQ(change_.kept().force.time_constant_s, 0.1);
  pass(3.8);
  EXPECT_EQ(state(), GainState::kOnTrial);
  pass(0.2);
  EXPECT_EQ(state(), GainState::kKept);
  EXPECT_EQ(change_.kept().force.time_constant_s, 0.2);
  EXPECT_EQ(change_.report().trouble, GainTrouble::kNone);
}

TEST_F(GainChangeTest, OnlyContactCountsForTheTrial) {
  change_.order(order(1, 0.2));
  pass(60.0, {.force_N = 0.0});
  EXPECT_EQ(state(), GainState::kOnTrial);
}

/// Else its gains would be on trial for ever, and a fault of days later would take them back.
TEST_F(GainChangeTest, AnArmThatFeelsNothingTriesThemByMoving) {
  change_.order(order(1, 0.2));
  pass(60.0, {.is_running = false, .can_feel = false});
  EXPECT_EQ(state(), GainState::kOnTrial);
  pass(4.1, {.can_feel = false});
  EXPECT_EQ(state(), GainState::kKept);
  EXPECT_EQ(T_s(), 0.2);
}

TEST_F(GainChangeTest, NeverSteps) {
  double before = T_s();
  std::uint32_t number = 0;
  for (int i = 0; i < 20000; ++i) {
    if (i % 700 == 0) change_.order(order(++number, i % 1400 == 0 ? 0.05 : 1.0));
    pass(kPeriod_s, {.force_N = 5.0, .has_fault = i % 5000 > 4990});
    ASSERT_LT(std::abs(std::log(T_s() / before)), 0.04) << i;
    before = T_s();
  }
}

/// Its law would meet all that has changed in the cycle in which it goes on.
TEST_F(GainChangeTest, StandsStillWhileAnArmIsHeldInContact) {
  const GainWatchInput held{.force_N = 5.0, .is_running = false, .is_held = true};
  change_.order(order(1, 0.2));
  pass(0.5);
  const double half_way_s = T_s();
  pass(60.0, held);
  EXPECT_EQ(T_s(), half_way_s);
  EXPECT_FALSE(change_.isChanging());
  EXPECT_EQ(state(), GainState::kRamping);
  pass(0.6);
  EXPECT_EQ(T_s(), 0.2);
  change_.order(order(2, 0.3));
  GainWatchInput free = held;
  free.force_N = 0.0;
  pass(2.0, free);
  EXPECT_EQ(T_s(), 0.3) << "nothing is balanced";
}

TEST_F(GainChangeTest, GoesBackFromTroubleAlsoWhileAnArmIsHeld) {
  change_.order(order(1, 0.2));
  pass(1.5);
  pass(kPeriod_s, {.force_N = 5.0, .has_fault = true, .is_running = false, .is_held = true});
  EXPECT_EQ(state(), GainState::kGoingBack);
  pass(0.2, {.force_N = 5.0, .has_fault = true, .is_running = false, .is_held = true});
  EXPECT_EQ(state(), GainState::kKept);
  EXPECT_EQ(T_s(), 0.1);
}

TEST_F(GainChangeTest, WaitsForAMomentWithoutContact) {
  GainOrder free = order(1, 0.2);
  free.waits_for_free = true;
  pass(1.0);
  change_.order(free);
  pass(10.0);
  EXPECT_EQ(state(), GainState::kWaiting);
  EXPECT_EQ(T_s(), 0.1);
  pass(1.6, {.force_N = 0.1});
  EXPECT_EQ(state(), GainState::kOnTrial);
  EXPECT_EQ(T_s(), 0.2);
}

/// The next one comes before the ramp would be at its end.
TEST_F(GainChangeTest, TakesNoBounceForAMomentWithoutContact) {
  GainOrder free = order(1, 0.2);
  free.waits_for_free = true;
  passForce(1.0, every(0.3));
  change_.order(free);
  passForce(5.0, every(0.3));
  EXPECT_EQ(state(), GainState::kWaiting);
  EXPECT_EQ(T_s(), 0.1);
}

/// A force that follows its limit would overshoot where that stops at once.
TEST_F(GainChangeTest, BeginsAndEndsItsRampSlowly) {
  change_.order(order(1, 0.2));
  pass(0.101);
  EXPECT_NEAR(T_s(), 0.1 * std::pow(2.0, 0.028), 1e-4);
  pass(0.8);
  EXPECT_NEAR(T_s(), 0.1 * std::pow(2.0, 0.972), 1e-4);
}

TEST_F(GainChangeTest, GoesBackByItselfAfterItsTime) {
  GainOrder passing = order(1, 0.2);
  passing.for_s = 10.0;
  change_.order(passing);
  pass(10.9);
  EXPECT_EQ(T_s(), 0.2);
  pass(1.2);
  EXPECT_EQ(T_s(), 0.1);
  EXPECT_EQ(state(), GainState::kKept);
  EXPECT_EQ(change_.report().trouble, GainTrouble::kTimeIsOver);
}

/// It has not begun on the way there.
TEST_F(GainChangeTest, TheTimeOfGainsEndsNoOrderThatComesOnTheirWay) {
  GainOrder timed = order(1, 0.2);
  timed.for_s = 0.3;
  change_.order(timed);
  pass(0.6);
  EXPECT_EQ(state(), GainState::kRamping);
  change_.order(order(2, 0.3));
  pass(3.0);
  EXPECT_EQ(T_s(), 0.3);
  EXPECT_EQ(change_.report().trouble, GainTrouble::kNone);
}

TEST_F(GainChangeTest, GoesBackWhereTheForceSwings) {
  pass(1.0);
  change_.order(order(1, 0.05));
  pass(0.6);
  passForce(1.5, swinging);
  EXPECT_EQ(state(), GainState::kKept);
  EXPECT_EQ(T_s(), 0.1);
  EXPECT_EQ(change_.report().trouble, GainTrouble::kSwings);
  EXPECT_NEAR(change_.report().figure, 2.0, 0.1);
}

/// What it does anyway is no reason.
TEST_F(GainChangeTest, StaysWhereTheForceSwungBefore) {
  passForce(3.0, swinging);
  change_.order(order(1, 0.05));
  passForce(6.0, swinging);
  EXPECT_EQ(state(), GainState::kKept);
  EXPECT_EQ(T_s(), 0.05);
}

TEST_F(GainChangeTest, GoesBackWhereContactIsLostAgainAndAgain) {
  change_ = GainChange(bouncy(), kPeriod_s);
  pass(1.0);
  change_.order(order(1, 0.05));
  passForce(3.0, every(0.1));
  EXPECT_EQ(T_s(), 0.1);
  EXPECT_EQ(change_.report().trouble, GainTrouble::kLosses);
  EXPECT_GT(change_.report().figure, change_.report().limit);
}

TEST_F(GainChangeTest, GoesBackWhereJointsAreAtTheirLimits) {
  pass(1.0);
  change_.order(order(1, 0.05));
  pass(2.0, {.force_N = 5.0, .is_at_limit = true});
  EXPECT_EQ(T_s(), 0.1);
  EXPECT_EQ(change_.report().trouble, GainTrouble::kAtLimits);
}

TEST_F(GainChangeTest, GoesBackAfterAFault) {
  change_.order(order(1, 0.05));
  pass(0.3);
  pass(kPeriod_s, {.has_fault = true});
  pass(0.2, {.force_N = 5.0});
  EXPECT_EQ(T_s(), 0.1);
  EXPECT_EQ(change_.report().trouble, GainTrouble::kFault);
}

/// Gains that were in contact for long enough are no less on trial while their time runs.
TEST_F(GainChangeTest, GoesBackHoweverLongItWentWell) {
  for (const bool is_fault : {false, true}) {
    change_ = GainChange(Gains{}, kPeriod_s);
    GainOrder passing = order(1, 0.05);
    passing.for_s = 100.0;
    change_.order(passing);
    pass(20.0);
    ASSERT_EQ(state(), GainState::kOnTrial);
    if (is_fault)
      pass(kPeriod_s, {.force_N = 5.0, .has_fault = true});
    else
      passForce(1.5, swinging);
    pass(0.2);
    EXPECT_EQ(T_s(), 0.1);
    EXPECT_EQ(change_.kept().force.time_constant_s, 0.1);
    EXPECT_EQ(change_.report().kept_number, 0u);
    EXPECT_EQ(change_.report().trouble, is_fault ? GainTrouble::kFault : GainTrouble::kSwings);
    EXPECT_EQ(state(), GainState::kKept);
  }
}

/// A new order while one is on trial goes back to what was kept, not to what was not.
TEST_F(GainChangeTest, ANewOrderGoesBackToWhatWasKept) {
  change_.order(order(1, 0.05));
  pass(1.0);
  change_.order(order(2, 0.04));
  pass(1.0);
  EXPECT_EQ(T_s(), 0.04);
  pass(kPeriod_s, {.has_fault = true});
  pass(0.2);
  EXPECT_EQ(T_s(), 0.1);
  EXPECT_EQ(change_.report().number, 2u);
}

/// Lost as often as before the change is no reason, and once in a while is none at all.
TEST_F(GainChangeTest, StaysWhereContactIsLostNoMoreThanBefore) {
  change_ = GainChange(bouncy(), kPeriod_s);
  passForce(5.0, every(0.1));
  change_.order(order(1, 0.05));
  passForce(10.0, every(0.1));
  EXPECT_EQ(change_.report().trouble, GainTrouble::kNone);
  EXPECT_EQ(T_s(), 0.05);
}

TEST_F(GainChangeTest, StaysWhereContactIsLostOnceInAWhile) {
  change_ = GainChange(bouncy(), kPeriod_s);
  pass(1.0);
  change_.order(order(1, 0.05));
  passForce(10.0, every(0.5));
  EXPECT_EQ(change_.report().trouble, GainTrouble::kNone);
  EXPECT_EQ(T_s(), 0.05);
}

/// What is remembered of bounces and limits fades for hours.
TEST_F(GainChangeTest, ForgetsDownToZeroAndNotToSubnormalNumbers) {
  for (int i = 0; i < 3; ++i) {
    pass(0.5, {.force_N = 5.0, .is_at_limit = true});
    pass(0.5, {.force_N = 0.0});
  }
  constexpr double kFaded_s = 8000.0;
  pass(kFaded_s, {.force_N = 0.0});
  std::feclearexcept(FE_UNDERFLOW);
  pass(1.0, {.force_N = 0.0});
  EXPECT_EQ(std::fetestexcept(FE_UNDERFLOW), 0);
}

/// On the way back of gains whose time was over: it is gone to its end while the next change waits,
/// and that change is not over with them.
TEST_F(GainChangeTest, WhatIsOrderedOnTheWayBackIsNeitherLostNorHoldsItUp) {
  for (const bool waits : {false, true}) {
    change_ = GainChange(Gains{}, kPeriod_s);
    GainOrder first = order(1, 0.3);
    first.for_s = 1.0;
    change_.order(first);
    for (int i = 0; i < 10000 && state() != GainState::kGoingBack; ++i) pass(kPeriod_s);
    pass(1.2);
    ASSERT_EQ(state(), GainState::kGoingBack) << "longer than the time that is over";
    GainOrder next = order(2, 0.2);
    next.waits_for_free = waits;
    change_.order(next);
    pass(5.0);
    EXPECT_EQ(state(), waits ? GainState::kWaiting : GainState::kOnTrial);
    EXPECT_EQ(T_s(), waits ? 0.1 : 0.2);
    pass(5.0, {});
    EXPECT_EQ(T_s(), 0.2);
    EXPECT_EQ(change_.report().number, 2u);
    EXPECT_EQ(change_.report().trouble, GainTrouble::kNone);
  }
}

/// Of gains that nobody has asked for: half way to those that the change which waits is laid over.
TEST_F(GainChangeTest, WhatWaitsDoesNotHoldUpTheRampBeforeIt) {
  for (const bool swings : {false, true}) {
    change_ = GainChange(Gains{}, kPeriod_s);
    pass(1.0);
    change_.order(order(1, 0.3));
    pass(0.2);
    GainOrder next = order(2, 0.2);
    next.waits_for_free = true;
    change_.order(next);
    if (swings) {
      passForce(5.0, swinging);
      EXPECT_EQ(change_.report().trouble, GainTrouble::kSwings);
      EXPECT_EQ(T_s(), 0.1);
      continue;
    }
    pass(5.0);
    EXPECT_EQ(state(), GainState::kWaiting);
    EXPECT_EQ(T_s(), 0.3);
    pass(2.5, {});
    EXPECT_EQ(T_s(), 0.2);
  }
}

}  // namespace
}  // namespace tactus
