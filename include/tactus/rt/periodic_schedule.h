#pragma once

#include <cstdint>

namespace tactus {

/// One wake-up of the loop.
struct Wake {
  std::int64_t t_ns = 0;           ///< when this cycle was due, CLOCK_MONOTONIC
  std::int64_t latency_ns = 0;     ///< from when the first of those left out, or this, was due
  std::int64_t skipped = 0;        ///< cycles left out between the last one and this one
  std::int64_t late_in_a_row = 0;  ///< cycles up to this one that were skipped or late; 0: on time
};

/// When the cycles of a loop are due: start + k periods, for ever in this phase. A cycle whose
/// whole period has gone by is skipped and counted, never caught up. A cycle is late if it was due
/// before the loop was ready to wait for it, or if cycles were skipped on the way to it.
class PeriodicSchedule {
 public:
  /// Throws std::invalid_argument unless period_ns > 0.
  PeriodicSchedule(std::int64_t start_ns, std::int64_t period_ns);

  std::int64_t due_ns() const noexcept { return due_ns_; }  ///< of the next cycle

  /// Begins a cycle: the loop was ready at ready_ns, and it is now_ns, not before due_ns().
  Wake wake(std::int64_t ready_ns, std::int64_t now_ns) noexcept;

 private:
  std::int64_t due_ns_;
  std::int64_t period_ns_;
  std::int64_t late_in_a_row_ = 0;
};

}  // namespace tactus
