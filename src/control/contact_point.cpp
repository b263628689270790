#include "tactus/control/contact_point.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

/// From the force to its normal part.
void turnToNormal(double moment_x_Nm, double cover_radius_m, ContactPointState& contact) noexcept {
  const double ratio = flushed(moment_x_Nm) / (cover_radius_m * contact.force_N);
  const double sine = std::clamp(ratio, -kMaxTiltSine, kMaxTiltSine);  // of -d
  const double cosine = std::sqrt(1.0 - sine * sine);
  const Vector3 F = contact.direction;
  contact.direction = Vector3(0.0, cosine * F.y() - sine * F.z(), cosine * F.z() + sine * F.y());
  contact.force_N *= cosine;
}

}  // namespace

void locateContact(const TactileSample& sample, const TactileModuleConfig& module,
                   ContactPointState& contact) noexcept {
  const double F_y = flushed(sample.force_y_N);  // their squares shall be normal numbers
  const double F_z = flushed(sample.force_z_N);
  const double force_squared = F_y * F_y + F_z * F_z;
  contact.force_N = std::sqrt(force_squared);
  if (contact.force_N <= kMinForceForDirection_N) return;
  const double x = (sample.moment_z_Nm * F_y - sample.moment_y_Nm * F_z) / force_squared;
  contact.position_m = std::clamp(x, 0.0, module.length_m);
  contact.direction = Vector3(0.0, F_y, F_z) / contact.force_N;
  if (sample.moment_x_Nm != 0.0) turnToNormal(sample.moment_x_Nm, module.cover_radius_m, contact);
}

double offCover_m(const TactileSample& sample, const TactileModuleConfig& config) noexcept {
  const double F_y = sample.force_y_N;
  const double F_z = sample.force_z_N;
  const double x = (sample.moment_z_Nm * F_y - sample.moment_y_Nm * F_z) / (F_y * F_y + F_z * F_z);
  return std::max({0.0, -x, x - config.length_m});
}

bool isValid(const TactileSample& sample, const TactileModuleConfig& config) noexcept {
  const double force = std::hypot(flushed(sample.force_y_N), flushed(sample.force_z_N));
  return force <= config.max_force_N && std::isfinite(sample.moment_y_Nm) &&
         std::isfinite(sample.moment_z_Nm) && std::isfinite(sample.moment_x_Nm);
}

}  // namespace tactus
