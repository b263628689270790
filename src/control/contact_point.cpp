#include "tactus/control/contact_point.h"

#include <algorithm>
#include <cmath>

#include "tactus/math/filter.h"

namespace tactus {

void locateContact(const TactileSample& sample, double link_length_m,
                   ContactPointState& contact) noexcept {
  const double F_y = flushed(sample.force_y_N);  // their squares shall be normal numbers
  const double F_z = flushed(sample.force_z_N);
  const double force_squared = F_y * F_y + F_z * F_z;
  contact.force_N = std::sqrt(force_squared);
  if (contact.force_N <= kMinForceForDirection_N) return;
  const double x = (sample.moment_z_Nm * F_y - sample.moment_y_Nm * F_z) / force_squared;
  contact.position_m = std::clamp(x, 0.0, link_length_m);
  contact.direction = Vector3(0.0, F_y, F_z) / contact.force_N;
}

bool isValid(const TactileSample& sample, const TactileModuleConfig& config) noexcept {
  const double force = std::hypot(flushed(sample.force_y_N), flushed(sample.force_z_N));
  return force <= config.max_force_N && std::isfinite(sample.moment_y_Nm) &&
         std::isfinite(sample.moment_z_Nm);
}

}  // namespace tactus
