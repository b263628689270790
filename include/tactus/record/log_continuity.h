#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/control/return_speed.h"
#include "tactus/supervisor/cycle_record.h"
#include "tactus/supervisor/mode.h"

namespace tactus {

/// A stretch of a run whose cycles cannot be replayed: what the controller remembered is in no log.
struct UnknownStretch {
  double from_s = 0.0, to_s = 0.0;  ///< t_s of its first and last cycle
  std::string reason;
};

/// Follows, cycle by cycle, whether the controller's state follows from what was logged before:
/// from the run's start on, but behind missing records only once a mode has reset it. What a reset
/// keeps of joint limits' ways out follows from where the arm was once it has run for
/// kReturnRise_s, and the age of a module's sample from the log once a new one has come.
class LogContinuity {
 public:
  /// has_missed: the log says how many cycles the loop missed. One of an older version does not:
  /// there each gap is taken for missed cycles.
  LogContinuity(const ControllerConfig& config, double period_s, bool has_missed)
      : period_s_(period_s),
        has_missed_(has_missed),
        settled_cycles_(config.has_joint_limit_avoidance ? kReturnRise_s / period_s + 1.0 : 0.0) {}

  /// What comes is part `part` of the run, counted from 0. Without a call it is part 0.
  void beginPart(int part) noexcept;

  /// The next cycle. True: the controller's state in it is known.
  bool add(const CycleRecord& recorded);

  /// What the loop missed just before that cycle.
  int missedCycles() const noexcept { return missed_; }
  const std::vector<UnknownStretch>& stretches() const noexcept { return stretches_; }

 private:
  void lose(double cycle);
  /// Whether each module that has told anything has told something new since the last gap.
  bool hasNewSamples(const CycleRecord& recorded, bool is_gap) noexcept;

  double period_s_;
  bool has_missed_;
  double settled_cycles_;  ///< of running, in which a reset keeps nothing from before them
  int next_part_ = 0;
  bool is_part_missing_ = false;  ///< just before the next cycle
  bool is_first_ = true;
  bool is_known_ = true;
  double cycle_before_ = -1.0;
  double running_cycles_ = 0.0;  ///< since the last reset or gap
  std::array<std::uint64_t, kMaxTactileModules> sequence_at_gap_{};
  unsigned new_samples_ = 0;  ///< bit i: of module i, since the last gap
  Mode mode_before_ = Mode::kBoot;
  int missed_ = 0;
  std::vector<UnknownStretch> stretches_;
};

}  // namespace tactus
