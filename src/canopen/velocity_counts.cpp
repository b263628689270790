#include "tactus/canopen/velocity_counts.h"

#include <cmath>
#include <limits>

namespace tactus {

std::int32_t VelocityCounts::next(double velocity) noexcept {
  constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
  const double wanted = velocity * counts_per_unit_ + carry_;
  if (std::abs(wanted) >= kLargest) {
    carry_ = 0.0;
    return wanted > 0.0 ? kLargest : -kLargest;
  }
  // Halves to even: a carried half on top of zero must not make the drive go to and fro.
  const double sent = std::nearbyint(wanted);
  carry_ = wanted - sent;
  return static_cast<std::int32_t>(sent);
}

}  // namespace tactus
