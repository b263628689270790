#pragma once

#include <string>
#include <vector>

#include "tactus/supervisor/cycle_record.h"
#include "tactus/supervisor/mode.h"

namespace tactus {

/// A stretch of a run whose cycles cannot be replayed: what the controller remembered is in no log.
struct UnknownStretch {
  double from_s = 0.0, to_s = 0.0;  ///< t_s of its first and last cycle
  std::string reason;
};

/// Follows, cycle by cycle, whether the controller's state follows from what was logged before:
/// from the run's start on, but behind missing records only once a mode has reset it.
class LogContinuity {
 public:
  /// has_missed: the log says how many cycles the loop missed. One of an older version does not:
  /// there each gap is taken for missed cycles.
  LogContinuity(double period_s, bool has_missed) : period_s_(period_s), has_missed_(has_missed) {}

  /// What comes is part `part` of the run, counted from 0. Without a call it is part 0.
  void beginPart(int part) noexcept;

  /// The next cycle. True: the controller's state in it is known.
  bool add(const CycleRecord& recorded);

  /// What the loop missed just before that cycle.
  int missedCycles() const noexcept { return missed_; }
  const std::vector<UnknownStretch>& stretches() const noexcept { return stretches_; }

 private:
  void lose(double cycle);

  double period_s_;
  bool has_missed_;
  int next_part_ = 0;
  bool is_part_missing_ = false;  ///< just before the next cycle
  bool is_first_ = true;
  bool is_known_ = true;
  double cycle_before_ = -1.0;
  Mode mode_before_ = Mode::kBoot;
  int missed_ = 0;
  std::vector<UnknownStretch> stretches_;
};

}  // namespace tactus
