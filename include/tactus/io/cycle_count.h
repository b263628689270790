#pragma once

#include <algorithm>
#include <cmath>

namespace tactus {

/// Cycles that last at least this long, at least one.
inline int cyclesLasting(double duration_s, double period_s) noexcept {
  constexpr double kMost = 1e9;
  constexpr double kRoundOff = 1e-9;  // 0.02 s of 0.001 s each are 20 cycles, not 21
  return static_cast<int>(std::clamp(std::ceil(duration_s / period_s - kRoundOff), 1.0, kMost));
}

}  // namespace tactus
