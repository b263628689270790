#include "tactus/rt/periodic_schedule.h"

#include <stdexcept>
#include <string>

namespace tactus {

PeriodicSchedule::PeriodicSchedule(std::int64_t start_ns, std::int64_t period_ns)
    : due_ns_(start_ns), period_ns_(period_ns) {
  if (period_ns <= 0) {
    throw std::invalid_argument("period of " + std::to_string(period_ns) +
                                " ns, expected more than 0");
  }
}

Wake PeriodicSchedule::wake(std::int64_t ready_ns, std::int64_t now_ns) noexcept {
  const std::int64_t skipped = (now_ns - due_ns_) / period_ns_;
  const bool is_late = skipped > 0 || ready_ns > due_ns_;
  late_in_a_row_ = is_late ? late_in_a_row_ + skipped + 1 : 0;
  const std::int64_t t_ns = due_ns_ + skipped * period_ns_;
  const std::int64_t latency_ns = now_ns - due_ns_;  // a period and more if it missed a cycle
  due_ns_ = t_ns + period_ns_;
  return {t_ns, latency_ns, skipped, late_in_a_row_};
}

}  // namespace tactus
