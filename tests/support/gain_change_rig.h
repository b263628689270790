#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>

#include "support/period.h"
#include "tactus/supervisor/gain_change.h"

namespace tactus::test {

/// An arm that rests in contact, if nothing else is said.
class GainChangeRig : public testing::Test {
 protected:
  void pass(double duration_s, GainWatchInput seen = {.force_N = 5.0}) {
    for (int i = 0; i < std::lround(duration_s / kPeriod_s); ++i) {
      change_.update(seen);
      ++cycle_;
    }
  }
  void passForce(double duration_s, const std::function<double(double)>& force) {
    for (int i = 0; i < std::lround(duration_s / kPeriod_s); ++i)
      pass(kPeriod_s, {.force_N = force(kPeriod_s * static_cast<double>(cycle_))});
  }
  GainOrder order(std::uint32_t number, double T_s) const {
    GainOrder order{.number = number, .gains = change_.kept()};
    order.gains.force.time_constant_s = T_s;
    return order;
  }
  double T_s() const { return change_.gains().force.time_constant_s; }
  GainState state() const { return change_.report().state; }

  GainChange change_{Gains{}, kPeriod_s};
  long cycle_ = 0;
};

}  // namespace tactus::test
