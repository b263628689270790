#pragma once

#include "tactus/supervisor/control_cycle.h"

namespace tactus::soak {

/// Who looks after the arm: comes when troubles are over, switches the enable line off and on
/// until it runs, and leaves when it has run for a while.
class Operator {
 public:
  /// come_ms: when; not_before_ms: when the arm may be left, at the earliest.
  Operator(int come_ms, int off_ms, int run_ms, int not_before_ms)
      : next_ms_(come_ms), off_ms_(off_ms), run_ms_(run_ms), not_before_ms_(not_before_ms) {}

  /// False: leaves.
  bool act(int now_ms, Mode mode, CycleInput& input) {
    if (mode == Mode::kOff) return false;
    if (now_ms < next_ms_) {
      if (is_off_) input.lines.enable = false;
      return true;
    }
    if (is_off_) on_ms_ = now_ms;
    is_off_ = false;
    if (mode == Mode::kRunning) {
      if (running_ms_ < 0) running_ms_ = now_ms;
      return now_ms < running_ms_ + run_ms_ || now_ms < not_before_ms_;
    }
    running_ms_ = -1;
    if (on_ms_ >= 0 && now_ms < on_ms_ + kAttempt_ms) return true;
    if (now_ms >= not_before_ms_ && attempts_++ == kAttempts) return false;
    is_off_ = true;
    input.lines.enable = false;
    next_ms_ = now_ms + off_ms_;
    return true;
  }

 private:
  static constexpr int kAttempt_ms = 3500;
  static constexpr int kAttempts = 4;

  int next_ms_, off_ms_, run_ms_, not_before_ms_;
  int on_ms_ = -1, running_ms_ = -1;
  int attempts_ = 0;
  bool is_off_ = false;
};

}  // namespace tactus::soak
