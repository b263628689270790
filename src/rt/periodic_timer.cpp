#include "tactus/rt/periodic_timer.h"

#include <time.h>

namespace tactus {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

std::int64_t now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond_ns + now.tv_nsec;
}

PeriodicTimer::PeriodicTimer(std::int64_t period_ns) : schedule_(0, period_ns) {
  const std::int64_t half_ns = period_ns / 2;
  const std::int64_t whole_periods = (now_ns() - half_ns) / period_ns + 2;
  schedule_ = PeriodicSchedule(whole_periods * period_ns + half_ns, period_ns);
}

Wake PeriodicTimer::wait() noexcept {
  const std::int64_t due_ns = schedule_.due_ns();
  const timespec due{due_ns / kSecond_ns, due_ns % kSecond_ns};
  const std::int64_t ready_ns = now_ns();
  std::int64_t time_ns = ready_ns;
  // The clock decides, not the result: a signal ends the sleep early, and a cycle that began early
  // because of it would be worse than a thread that spins.
  while (time_ns < due_ns) {
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
    time_ns = now_ns();
  }
  return schedule_.wake(ready_ns, time_ns);
}

}  // namespace tactus
