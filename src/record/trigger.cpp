#include "tactus/record/trigger.h"

#include <cmath>

namespace tactus {

bool Trigger::holds(double value, double level) const noexcept {
  switch (config_.comparison) {
    case Comparison::kAbove:
      return value > level;
    case Comparison::kAtLeast:
      return value >= level;
    case Comparison::kBelow:
      return value < level;
    case Comparison::kAtMost:
      return value <= level;
  }
  return false;
}

bool Trigger::update(double t_s, double value) noexcept {
  if (std::isnan(value)) return false;
  const bool is_rising =
      config_.comparison == Comparison::kAbove || config_.comparison == Comparison::kAtLeast;
  const double nearer = is_rising ? -config_.hysteresis : config_.hysteresis;
  if (!holds(value, config_.level + nearer)) is_armed_ = true;
  if (!is_armed_ || !holds(value, config_.level)) return false;
  is_armed_ = false;
  if (has_fired_ && t_s < fired_s_ + config_.holdoff_s) return false;
  has_fired_ = true;
  fired_s_ = t_s;
  return true;
}

}  // namespace tactus
