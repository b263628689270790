#include "tactus/io/debounce.h"

#include <algorithm>
#include <cmath>

namespace tactus {

bool Debounce::update(bool level) noexcept {
  changed_cycles_ = level == is_active_ ? 0 : changed_cycles_ + 1;
  const int needed = std::max(1, is_active_ ? release_cycles_ : activation_cycles_);
  if (changed_cycles_ >= needed) {
    is_active_ = level;
    changed_cycles_ = 0;
  }
  return is_active_;
}

int cyclesCovering(double duration_s, double period_s) noexcept {
  constexpr double kRounding = 1e-9;  // 0.003 / 0.001 is a little more than 3
  constexpr double kMany = 1e9;       // more than a run has
  return static_cast<int>(std::min(kMany, std::ceil(duration_s / period_s - kRounding)));
}

}  // namespace tactus
