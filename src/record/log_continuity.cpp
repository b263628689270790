#include "tactus/record/log_continuity.h"

#include <algorithm>
#include <cmath>

#include "tactus/supervisor/apply_mode.h"

namespace tactus {
namespace {

/// A longer gap is none that a loop went on after.
constexpr double kMaxMissedCycles = 1e6;

int asMissed(double cycles) noexcept {
  return cycles > 0.0 && cycles <= kMaxMissedCycles ? static_cast<int>(cycles) : 0;
}

}  // namespace

void LogContinuity::beginPart(int part) noexcept {
  is_part_missing_ = is_part_missing_ || part != next_part_;
  next_part_ = part + 1;
}

bool LogContinuity::add(const CycleRecord& recorded) {
  const double cycle = std::round(recorded.t_s / period_s_);
  const Mode mode = static_cast<Mode>(recorded.mode);
  const auto logged = static_cast<double>(recorded.missed_cycles);
  if (is_first_ && is_part_missing_) cycle_before_ = cycle - 1.0 - logged;
  const double gap = cycle - cycle_before_ - 1.0;
  missed_ = asMissed(has_missed_ ? logged : gap);
  const bool is_gap = is_part_missing_ || (has_missed_ && gap != logged);
  if (is_gap) lose(cycle);
  // The mode before a gap is unknown, too: the same, which resets nothing.
  // A reference that has waited goes on where it was, which no reset tells to the bit.
  const bool has_waited = recorded.path_time_s != recorded.task_time_s;
  const bool is_reset = resetsController(mode, is_gap ? mode : mode_before_);
  const bool has_samples = hasNewSamples(recorded, is_gap);
  if (is_gap) running_cycles_ = 0.0;
  if (is_reset && running_cycles_ >= settled_cycles_ && !has_waited && has_samples)
    is_known_ = true;
  // What goes on after a retreat, or may after a hold, returns as gently as after a reset.
  if (is_reset || mode == Mode::kRetreating || mode == Mode::kHolding) running_cycles_ = 0.0;
  if (mode == Mode::kRunning)
    running_cycles_ += 1.0 + (!is_gap && mode_before_ == Mode::kRunning ? missed_ : 0);
  if (!is_known_) stretches_.back().to_s = recorded.t_s;
  is_first_ = is_part_missing_ = false;
  cycle_before_ = cycle;
  mode_before_ = mode;
  return is_known_;
}

bool LogContinuity::hasNewSamples(const CycleRecord& recorded, bool is_gap) noexcept {
  if (is_gap) {
    std::copy_n(recorded.tactile_sequence, kMaxTactileModules, sequence_at_gap_.begin());
    new_samples_ = 0;
  }
  bool all = true;
  for (int i = 0; i < kMaxTactileModules; ++i) {
    const std::uint64_t sequence = recorded.tactile_sequence[i];
    if (sequence != sequence_at_gap_[i]) new_samples_ |= 1U << i;
    all = all && (sequence == 0 || (new_samples_ >> i & 1U) != 0);
  }
  return all;
}

void LogContinuity::lose(double cycle) {
  if (!is_known_) return;  // goes on
  is_known_ = false;
  stretches_.push_back({std::min(cycle_before_ + 1.0, cycle) * period_s_, (cycle - 1.0) * period_s_,
                        is_part_missing_ ? "the part before is missing" : "records are missing"});
}

}  // namespace tactus
