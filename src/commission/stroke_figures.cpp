#include "tactus/commission/stroke_figures.h"

#include <algorithm>
#include <cmath>

namespace tactus {

void StrokeFigures::add(double commanded, double speed, double measured) noexcept {
  const double error = commanded - measured;
  values_.largest_error = std::max(values_.largest_error, std::abs(error));
  error_speed_ += error * speed;
  speed_speed_ += speed * speed;
  last_[next_] = measured;
  next_ = (next_ + 1) % last_.size();
  size_ = std::min(size_ + 1, last_.size());
  if (size_ < last_.size()) return;
  const double oldest = last_[next_], middle = last_[(next_ + kHalf) % last_.size()];
  const double half_s = kHalf * period_s_;
  const double acceleration = (measured - 2.0 * middle + oldest) / (half_s * half_s);
  values_.largest_acceleration = std::max(values_.largest_acceleration, std::abs(acceleration));
}

/// Least squares of error = lag * speed.
StrokeValues StrokeFigures::values() const noexcept {
  StrokeValues values = values_;
  values.lag_s = speed_speed_ > 0.0 ? error_speed_ / speed_speed_ : 0.0;
  return values;
}

}  // namespace tactus
