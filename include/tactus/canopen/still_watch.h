#pragma once

#include <algorithm>
#include <cmath>

#include "tactus/canopen/cycle_count.h"

namespace tactus {

/// Tells a joint that rests by its measured position alone, which encoders' noise does not hide as
/// it does a velocity: it has stayed within kWay for kTime_s.
class StillWatch {
 public:
  static constexpr double kWay = 2e-3;  ///< m or rad
  static constexpr double kTime_s = 0.2;

  explicit StillWatch(double period_s) : time_cycles_(cyclesLasting(kTime_s, period_s)) {}

  void restart() noexcept { cycles_ = 0; }

  /// Once for each position that is heard.
  void update(double position) noexcept {
    const bool is_still = std::abs(position - position_) <= kWay;
    if (!is_still) position_ = position;
    cycles_ = is_still ? std::min(cycles_ + 1, time_cycles_) : 0;
  }

  bool isStill() const noexcept { return cycles_ >= time_cycles_; }

 private:
  int time_cycles_;
  int cycles_ = 0;
  double position_ = 0.0;  ///< where it has stayed
};

}  // namespace tactus
