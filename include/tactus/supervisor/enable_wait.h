#pragma once

#include "tactus/supervisor/line_states.h"

namespace tactus {

/// An enable line that is on as a program starts says nothing of an arm that was left anywhere: a
/// restart after a crash would move it unasked. So it counts only once it was off for so many
/// cycles in a row: a line that flickers is off for one.
class EnableWait {
 public:
  /// off_cycles: 0: does not wait.
  explicit EnableWait(int off_cycles) : off_cycles_(off_cycles), left_(off_cycles) {}

  /// The lines of this cycle, as they count.
  GpioInputs update(GpioInputs lines) noexcept {
    const bool is_off = lines.is_valid && !lines.enable;
    if (left_ > 0) left_ = is_off ? left_ - 1 : off_cycles_;
    lines.must_go_off = lines.enable && left_ > 0;
    lines.enable = lines.enable && left_ == 0;
    return lines;
  }

 private:
  int off_cycles_, left_;
};

}  // namespace tactus
