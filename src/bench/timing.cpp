#include "tactus/bench/timing.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace tactus {
namespace {

using Clock = std::chrono::steady_clock;

double nanosecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

/// What a pair of clock calls measures when nothing happens between them.
double clockTime_ns() {
  double shortest = 1e9;
  for (int i = 0; i < 100; ++i) shortest = std::min(shortest, nanosecondsSince(Clock::now()));
  return shortest;
}

}  // namespace

TimeStatistics statistics(std::vector<double> times_ns) {
  if (times_ns.empty()) return {};
  std::ranges::sort(times_ns);
  const auto at = [&](double share) {
    return times_ns[static_cast<std::size_t>(share * static_cast<double>(times_ns.size() - 1))];
  };
  return {times_ns.front(), at(0.5), at(0.9)};
}

TimeStatistics timeWarm(int batches, int calls, const std::function<void()>& prepare,
                        const std::function<void()>& batch) {
  prepare();
  batch();
  std::vector<double> times_ns;
  for (int i = 0; i < batches; ++i) {
    prepare();
    const Clock::time_point start = Clock::now();
    batch();
    times_ns.push_back(nanosecondsSince(start) / calls);
  }
  return statistics(std::move(times_ns));
}

void CacheWalker::walk() noexcept {
  constexpr std::size_t kLine = 64 / sizeof(unsigned);
  for (std::size_t i = 0; i < memory_.size(); i += kLine) ++memory_[i];
}

TimeStatistics timeCold(int calls, CacheWalker& walker, const std::function<void(int)>& prepare,
                        const std::function<void(int)>& call) {
  const double clock_ns = clockTime_ns();
  std::vector<double> times_ns;
  for (int i = 0; i < calls; ++i) {
    prepare(i);
    walker.walk();
    const Clock::time_point start = Clock::now();
    call(i);
    times_ns.push_back(std::max(0.0, nanosecondsSince(start) - clock_ns));
  }
  return statistics(std::move(times_ns));
}

}  // namespace tactus
