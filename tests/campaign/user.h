#pragma once

#include "campaign/plan.h"
#include "tactus/supervisor/mode.h"

namespace tactus::campaign {

/// What the user does with line and stop request.
class User {
 public:
  explicit User(const Plan& plan) : plan_(plan), next_ms_(plan.clear_ms) {}

  /// False: the run is over.
  bool act(int now_ms, Mode mode, CycleInput& input) {
    if (is_stopping_) input.stop_requested = true;
    if (mode == Mode::kOff) return false;
    if (now_ms < next_ms_) {
      if (is_off_ || isBouncing(now_ms)) input.lines.enable = false;
      return true;
    }
    if (is_over_) return false;
    const bool is_mended = plan_.ending == Ending::kMendStop && on_ms_ < 0 && !is_off_;
    if (is_mended && mode == Mode::kRunning) return false;
    return plan_.ending == Ending::kLeave  ? wait(now_ms, kLeft_ms)
           : plan_.ending == Ending::kStop ? stop(now_ms)
                                           : goOn(now_ms, mode, input);
  }

 private:
  bool isBouncing(int now_ms) const {
    return on_ms_ >= 0 && now_ms < on_ms_ + plan_.bounce_ms && now_ms % 3 == 0;
  }

  bool wait(int now_ms, int duration_ms) {
    next_ms_ = now_ms + duration_ms;
    is_over_ = true;
    return true;
  }

  bool stop(int now_ms) {
    is_stopping_ = true;
    return wait(now_ms, kStopWait_ms);
  }

  bool goOn(int now_ms, Mode mode, CycleInput& input) {
    if (is_off_) {  // and on again
      is_off_ = false;
      on_ms_ = now_ms;
    } else if (on_ms_ < 0 || (mode != Mode::kRunning && now_ms > on_ms_ + kAttempt_ms)) {
      if (attempts_++ == plan_.attempts) return stop(now_ms);
      is_off_ = true;
      input.lines.enable = false;
      next_ms_ = now_ms + plan_.off_ms;
    } else if (mode == Mode::kRunning && now_ms > on_ms_) {
      if (has_gone_on_) return plan_.ending != Ending::kGoOn && stop(now_ms);
      has_gone_on_ = true;
      next_ms_ = now_ms + plan_.go_on_ms;
    }
    return true;
  }

  static constexpr int kLeft_ms = 10'000;  ///< that nobody does anything
  static constexpr int kAttempt_ms = 3500;
  static constexpr int kStopWait_ms = 9000;  ///< after a stop request

  const Plan& plan_;
  int next_ms_;
  int on_ms_ = -1;
  int attempts_ = 0;
  bool is_off_ = false, has_gone_on_ = false, is_stopping_ = false, is_over_ = false;
};

}  // namespace tactus::campaign
