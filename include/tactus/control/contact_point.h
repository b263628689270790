#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"

namespace tactus {

/// What the tactile module says, module frame (x along the link).
struct ContactPointState {
  double force_N = 0.0;                 ///< F_sen
  double position_m = 0.0;              ///< x of the contact on the link's axis
  Vector3 direction = Vector3::Zero();  ///< F^, unit force on the robot; zero before any contact
  double interval_s = 0.0;              ///< from the sample before to this one; 0: it is not new

  bool isNew() const noexcept { return interval_s > 0.0; }
};

/// Force below which point and direction of contact are noise; the last ones stay.
inline constexpr double kMinForceForDirection_N = 0.05;

/// Force, point and direction of the one contact that explains a sample:
///   x = (M_z F_y - M_y F_z) / (F_y^2 + F_z^2)
void locateContact(const TactileSample& sample, double link_length_m,
                   ContactPointState& contact) noexcept;

/// Finite and within the module's range?
bool isValid(const TactileSample& sample, const TactileModuleConfig& config) noexcept;

}  // namespace tactus
