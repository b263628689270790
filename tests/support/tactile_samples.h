#pragma once

#include <cmath>
#include <cstdint>

#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"

namespace tactus::test {

/// What the module feels of a force that pushes on the cover at x_m along the link, at an angle
/// about the link's axis (0: along y, pi/2: along z).
inline TactileModuleConfig moduleOfLength(double length_m) {
  TactileModuleConfig module;
  module.length_m = length_m;
  return module;
}

inline TactileSample touchAt(double x_m, double force_N, double angle_rad, std::uint32_t sequence) {
  const double F_y = force_N * std::cos(angle_rad);
  const double F_z = force_N * std::sin(angle_rad);
  return {F_y, F_z, -x_m * F_z, x_m * F_y, sequence};
}

}  // namespace tactus::test
