#pragma once

#include "tactus/rt/periodic_schedule.h"

namespace tactus {

/// CLOCK_MONOTONIC, through the vDSO: no system call where the clock source allows it.
std::int64_t now_ns() noexcept;

/// Sleeps to the absolute times of a PeriodicSchedule: at (k + 1/2) periods of CLOCK_MONOTONIC. On
/// whole ones other programs' timers tend to expire, in newer kernels the tick as well, and a
/// wake-up that shares its instant with theirs is a few us late. So each start has one phase.
class PeriodicTimer {
 public:
  /// The first cycle is due in one to two periods. Throws std::invalid_argument unless
  /// period_ns > 0.
  explicit PeriodicTimer(std::int64_t period_ns);

  /// Returns when the next cycle is due, at once if it is already.
  Wake wait() noexcept;

 private:
  PeriodicSchedule schedule_;
};

}  // namespace tactus
