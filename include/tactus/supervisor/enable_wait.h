#pragma once

#include "tactus/supervisor/line_states.h"

namespace tactus {

/// An enable line that is on as a program starts says nothing of an arm that was left anywhere: a
/// restart after a crash would move it unasked. So it counts only once it was seen off.
class EnableWait {
 public:
  explicit EnableWait(bool waits) : waits_(waits) {}

  /// The lines of this cycle, as they count.
  GpioInputs update(GpioInputs lines) noexcept {
    waits_ = waits_ && (lines.enable || !lines.is_valid);
    lines.enable = lines.enable && !waits_;
    return lines;
  }

 private:
  bool waits_;
};

}  // namespace tactus
