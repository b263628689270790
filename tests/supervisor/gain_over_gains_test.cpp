#include <gtest/gtest.h>

#include <cmath>

#include "tactus/supervisor/gain_change.h"

/// Gains that are ordered while others ramp, are on trial or go back.
namespace tactus {
namespace {

constexpr double kOverPeriod_s = 0.001;

class GainOverGains : public testing::Test {
 protected:
  void pass(double duration_s, const GainWatchInput& seen = {.force_N = 5.0}) {
    for (int i = 0; i < std::lround(duration_s / kOverPeriod_s); ++i) change_.update(seen);
  }
  GainOrder order(std::uint32_t number, double T_s) const {
    GainOrder order{.number = number, .gains = change_.kept()};
    order.gains.force.time_constant_s = T_s;
    return order;
  }
  double T_s() const { return change_.gains().force.time_constant_s; }
  GainState state() const { return change_.report().state; }

  GainChange change_{Gains{}, kOverPeriod_s};
};

/// The way that was begun is as long as if nothing waited, there and back.
TEST_F(GainOverGains, WhatWaitsDoesNotHurryTheRampBeforeIt) {
  for (const bool is_back : {false, true}) {
    change_ = GainChange(Gains{}, kOverPeriod_s);
    GainChange alone = change_;
    const auto passBoth = [&](double duration_s, const GainWatchInput& seen) {
      for (int i = 0; i < std::lround(duration_s / kOverPeriod_s); ++i) {
        change_.update(seen);
        alone.update(seen);
        ASSERT_EQ(T_s(), alone.gains().force.time_constant_s) << i;
      }
    };
    for (GainChange* change : {&change_, &alone}) change->order(order(1, 0.3));
    passBoth(0.4, {.force_N = 5.0});
    if (is_back) passBoth(kOverPeriod_s, {.force_N = 5.0, .has_fault = true});
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
      change_ = GainChange(Gains{}, kOverPeriod_s);
      GainOrder first = order(1, 0.3);
      if (!has_fault) first.for_s = 1.0;
      change_.order(first);
      while (state() != GainState::kOnTrial) pass(kOverPeriod_s);
      if (!has_fault) pass(waits ? 0.5 : 1.0 - kOverPeriod_s);
      ASSERT_EQ(state(), GainState::kOnTrial);
      GainOrder next = order(2, 0.2);
      next.waits_for_free = waits;
      change_.order(next);
      if (!has_fault && waits) pass(0.5 - kOverPeriod_s);
      pass(has_fault ? kOverPeriod_s : 2.0 * kOverPeriod_s,
           {.force_N = 5.0, .has_fault = has_fault});
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
  pass(kOverPeriod_s, {.force_N = 5.0, .has_fault = true});
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
