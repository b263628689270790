#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"
#include "tactus/math/filter.h"
#include "tactus/math/serial_chain.h"

namespace tactus {

/// What the tactile module says, module frame (x along the link).
struct ContactPointState {
  double force_N = 0.0;     ///< F_sen; its normal part where M_x is felt
  double position_m = 0.0;  ///< x of the contact on the link's axis
  /// F^, unit force on the robot, zero before any contact; with M_x the cover's normal.
  Vector3 direction = Vector3::Zero();
  double interval_s = 0.0;  ///< from the sample before to this one; 0: it is not new

  bool isNew() const noexcept { return interval_s > 0.0; }
};

/// A contact in the base frame.
struct PlacedContact {
  Vector3 p_Base;  ///< m
  Vector3 F_Base;  ///< F^
};

inline PlacedContact placed(const ChainPose& pose, const AttachedFrame& link,
                            const ContactPointState& contact) noexcept {
  const Pose& X_JointModule = link.X_JointFrame;
  const Vector3 p_Joint = X_JointModule.p_AB + contact.position_m * X_JointModule.R_AB.col(0);
  const Vector3 F_Joint = X_JointModule.R_AB.lazyProduct(contact.direction);
  return {pointInBase(pose, link.joint, p_Joint), vectorInBase(pose, link.joint, F_Joint)};
}

/// Force below which point and direction of contact are noise; the last ones stay.
inline constexpr double kMinForceForDirection_N = 0.05;

/// sin of the largest angle between force and normal that M_x is believed: atan 1. Whatever a
/// broken channel says, 0.71 of the force is felt, and within 45 degrees of where it points.
inline constexpr double kMaxTiltSine = 0.70710678;

// clang-format off: equations
/// Force, point and direction of the one contact that explains a sample:
///   x = (M_z F_y - M_y F_z) / (F_y^2 + F_z^2)
/// With M_x, and friction F_t = F_t u x n at the cover's surface, -r n from its axis u:
///   M_x = (-r n x F) u = -r F_t,   sin d = F_t / F = -M_x / (r F),   n = Rot(u, -d) F^,
///   F_n = F cos d
// clang-format on
void locateContact(const TactileSample& sample, const TactileModuleConfig& module,
                   ContactPointState& contact) noexcept;

/// A force of so much of the module's range has a place on its cover, or a module length off it at
/// most, as of two pushes from opposite sides. Of a weaker one noise may say anything.
inline constexpr double kTellingShare = 0.1;

inline bool tellsItsPlace(const TactileSample& sample, const TactileModuleConfig& config) noexcept {
  const double telling_N = kTellingShare * config.max_force_N;
  const double F_y = flushed(sample.force_y_N), F_z = flushed(sample.force_z_N);
  return F_y * F_y + F_z * F_z > telling_N * telling_N;
}

/// How far off the cover the push is that explains a sample with a force, m; 0: on it.
double offCover_m(const TactileSample& sample, const TactileModuleConfig& config) noexcept;

/// Finite and within the module's range?
bool isValid(const TactileSample& sample, const TactileModuleConfig& config) noexcept;

}  // namespace tactus
