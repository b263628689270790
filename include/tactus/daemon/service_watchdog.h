#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>
#include <thread>

#include "tactus/daemon/loop_link.h"

namespace tactus {

/// Whether the loop is alive, from one look at its pulse to the next.
class LoopHealth {
 public:
  LoopHealth(const LoopPulse& pulse, int max_late_cycles)
      : pulse_(pulse), max_late_cycles_(max_late_cycles) {}

  /// True: the loop has counted cycles since the last look, and is not later than the fault
  /// `overrun` allows; or it has ended. Then the arm rests, and a disk may keep what is left of the
  /// log waiting: a manager that ended that as a hang would start the daemon again, after a fault,
  /// too, and the arm would move unasked.
  bool look() noexcept;

 private:
  const LoopPulse& pulse_;
  const int max_late_cycles_;
  std::int64_t seen_cycles_ = 0;
};

/// Feeds the service manager's watchdog (WatchdogSec= of the unit) while the loop is healthy. In a
/// thread of its own: a disk or a terminal that keeps the telemetry waiting must not end a motion
/// that is well. No thread without NOTIFY_SOCKET and WATCHDOG_USEC in the environment.
class ServiceWatchdog {
 public:
  ServiceWatchdog(const LoopPulse& pulse, int max_late_cycles);

 private:
  void watch(const std::stop_token& stop, std::chrono::microseconds period);

  LoopHealth health_;
  std::mutex mutex_;  ///< for the wait alone
  std::condition_variable_any wait_;
  std::jthread thread_;
};

}  // namespace tactus
