#pragma once

#include <algorithm>
#include <cmath>

namespace tactus {

/// Cycles that cover a duration >= 0; none for none.
inline int cyclesCovering(double duration_s, double period_s) noexcept {
  constexpr double kMost = 1e9;       // more than a run has
  constexpr double kRoundOff = 1e-6;  // 0.02 s of 0.001 s each are 20 cycles, not 21
  return static_cast<int>(std::min(kMost, std::ceil(duration_s / period_s - kRoundOff)));
}

/// Likewise, but at least one.
inline int cyclesLasting(double duration_s, double period_s) noexcept {
  return std::max(1, cyclesCovering(duration_s, period_s));
}

/// Cycles that end within a duration, but at least one.
inline int cyclesWithin(double duration_s, double period_s) noexcept {
  const int covering = cyclesLasting(duration_s, period_s);
  constexpr double kRoundOff = 1e-6;
  return covering > 1 && covering * period_s > duration_s + kRoundOff * period_s ? covering - 1
                                                                                 : covering;
}

}  // namespace tactus
