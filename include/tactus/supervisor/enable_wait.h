#pragma once

#include <algorithm>

#include "tactus/supervisor/line_states.h"

namespace tactus {

/// An enable line that goes off counts as off at once, but as on again only once it was off for so
/// many cycles in a row: off and on is how people let a stopped arm go on, and a contact that
/// chatters is nobody's word. It has to be off first as a program starts, too: a line that is on is
/// of before, and a restart after a crash, or after a hang that a fault was latched in, would move
/// the arm unasked.
class EnableWait {
 public:
  /// off_cycles: 0 without such a line.
  explicit EnableWait(int off_cycles) : off_cycles_(off_cycles), left_(off_cycles) {}

  /// The lines of this cycle, as they count.
  GpioInputs update(GpioInputs lines) noexcept {
    const bool is_off = lines.is_valid && lines.is_enable_off;
    if (is_off && was_on_) left_ = off_cycles_;
    if (left_ > 0) left_ = is_off ? left_ - 1 : off_cycles_;
    lines.must_go_off = lines.is_valid && !is_off && left_ > 0;
    lines.enable = lines.enable && left_ == 0;
    was_on_ = !is_off && (was_on_ || lines.enable);
    return lines;
  }

 private:
  int off_cycles_, left_;
  bool was_on_ = false;  ///< and counted
};

}  // namespace tactus
