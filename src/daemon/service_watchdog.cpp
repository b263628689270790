#include "tactus/daemon/service_watchdog.h"

#include <systemd/sd-daemon.h>

#include <system_error>

#include "tactus/io/service_manager.h"

namespace tactus {
namespace {

/// Looks in the time after which the manager gives up: a look or two may come late.
constexpr int kLooks = 4;

}  // namespace

bool LoopHealth::look() noexcept {
  const std::int64_t cycles = pulse_.cycles.load(std::memory_order_relaxed);
  const bool has_moved_on = cycles != seen_cycles_;
  seen_cycles_ = cycles;
  if (pulse_.has_ended.load(std::memory_order_relaxed)) return true;
  return has_moved_on && pulse_.late_in_a_row.load(std::memory_order_relaxed) <= max_late_cycles_;
}

ServiceWatchdog::ServiceWatchdog(const LoopPulse& pulse, int max_late_cycles)
    : health_(pulse, max_late_cycles) {
  std::uint64_t timeout_us = 0;
  if (sd_watchdog_enabled(0, &timeout_us) <= 0) return;
  const std::chrono::microseconds period(timeout_us / kLooks);
  try {
    thread_ = std::jthread([this, period](const std::stop_token& stop) { watch(stop, period); });
  } catch (const std::system_error& error) {
    throw std::system_error(error.code(), "starting the thread of the service's watchdog");
  }
}

void ServiceWatchdog::watch(const std::stop_token& stop, std::chrono::microseconds period) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    wait_.wait_for(lock, stop, period, [] { return false; });
    if (health_.look()) tellManager("WATCHDOG=1");
  }
}

}  // namespace tactus
