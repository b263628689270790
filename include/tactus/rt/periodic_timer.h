#pragma once

#include "tactus/rt/periodic_schedule.h"

namespace tactus {

/// CLOCK_MONOTONIC, through the vDSO: no system call where the clock source allows it.
std::int64_t now_ns() noexcept;

/// Sleeps to the absolute times of a PeriodicSchedule whose first cycle is due a period from now.
class PeriodicTimer {
 public:
  /// Throws std::invalid_argument unless period_ns > 0.
  explicit PeriodicTimer(std::int64_t period_ns) : schedule_(now_ns() + period_ns, period_ns) {}

  /// Returns when the next cycle is due, at once if it is already.
  Wake wait() noexcept;

 private:
  PeriodicSchedule schedule_;
};

}  // namespace tactus
