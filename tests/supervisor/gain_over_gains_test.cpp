#include <gtest/gtest.h>

#include <cmath>

#include "support/gain_change_rig.h"

/// Gains that are ordered while others ramp, are on trial or go back.
namespace tactus {
namespace {

using test::kPeriod_s;

class GainOverGains : public test::GainChangeRig {};

/// The way that was begun is as long as if nothing waited, there and back.
TEST_F(GainOverGains, WhatWaitsDoesNotHurryTheRampBeforeIt) {
  for (const bool is_back : {false, true}) {
    change_ = GainChange(Gains{}, kPeriod_s);
    GainChange alone = change_;
    const auto passBoth = [&](double duration_s, const GainWatchInput& seen) {
      for (int i = 0; i < std::lround(duration_s / kPeriod_s); ++i) {
        change_.update(seen);
        alone.update(seen);
        ASSERT_EQ(T_s(), alone.gains().force.time_constant_s) << i;
      }
    };
    for (GainChange* change : {&change_, &alone}) change->order(order(1, 0.3));
    passBoth(0.4, {.force_N = 5.0});
    if (is_back) passBoth(kPeriod_s, {.force_N = 5.0, .has_fault = true});
    GainOrder next = order(2, 0.2);
    next.waits_for_free = true;
    change_.order(next);
    passBoth(3.0, {.force_N = 5.0});
    EXPECT_EQ(state(), GainState::kWaiting);
    EXPECT_EQ(T_s(), is_back ? 0.1 : 0.3);
  }
}

/// Gains on trial are watched, and their time runs, while the next wait for a moment without
/// contact, and in the cycle in which the next come.
TEST_F(GainOverGains, WhatIsOrderedOverATrialDoesNotSaveIt) {
  for (const bool waits : {false, true}) {
    for (const bool has_fault : {false, true}) {
      change_ = GainChange(Gains{}, kPeriod_s);
      GainOrder first = order(1, 0.3);
      if (!has_fault) first.for_s = 1.0;
      change_.order(first);
      while (state() != GainState::kOnTrial) pass(kPeriod_s);
      if (!has_fault) pass(waits ? 0.5 : 1.0 - kPeriod_s);
      ASSERT_EQ(state(), GainState::kOnTrial);
      GainOrder next = order(2, 0.2);
      next.waits_for_free = waits;
      change_.order(next);
      if (!has_fault && waits) pass(0.5 - kPeriod_s);
      pass(has_fault ? kPeriod_s : 2.0 * kPeriod_s, {.force_N = 5.0, .has_fault = has_fault});
      EXPECT_EQ(state(), GainState::kGoingBack) << waits << has_fault;
      EXPECT_EQ(change_.report().trouble,
                has_fault ? GainTrouble::kFault : GainTrouble::kTimeIsOver);
    }
  }
}

/// One that was made over gains which have gone back meanwhile goes back with them, and says so.
TEST_F(GainOverGains, AnOrderOverGainsThatWentBackIsReportedWithThem) {
  change_.order(order(1, 0.3));
  pass(2.0);
  pass(kPeriod_s, {.force_N = 5.0, .has_fault = true});
  GainOrder over = order(2, 0.3);
  over.gains.force.damping *= 1.1;
  over.over = 1;
  change_.order(over);
  EXPECT_EQ(change_.report().number, 2u);
  EXPECT_EQ(change_.report().trouble, GainTrouble::kFault);
  pass(2.0);
  EXPECT_EQ(change_.report().number, 2u);
  EXPECT_EQ(state(), GainState::kKept);
  EXPECT_EQ(T_s(), 0.1);
}

}  // namespace
}  // namespace tactus
