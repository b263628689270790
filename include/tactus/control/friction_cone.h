#pragma once

#include "tactus/control/contact_point.h"
#include "tactus/control/controller_config.h"
#include "tactus/control/speed_rows.h"

namespace tactus {

// clang-format off: equations
/// The contacts that a sensed force may come from, where friction of up to mu_max tilts it: four
/// corners, whose approach is limited one by one,
///   a_jk = J(x + k mu_max r)^T Rot(u, j atan mu_max) F^,     j, k = +1, -1
/// u: the link's axis; r: the cover's radius; x, F^: point and direction as sensed. Every normal
/// within atan mu_max of F^ is a positive combination of the two edges, so whatever F^ says of it,
/// and however late, its approach is limited too. The friction along the axis is not felt, but
/// shifts x = M / F by up to mu r. Derived in docs/approach_speed_limit.md.
// clang-format on
class FrictionCone {
 public:
  FrictionCone(const TactileModuleConfig& module, double friction_coefficient);

  double cosine() const noexcept { return cos_; }  ///< of atan mu_max

  /// Adds four rows; speed and damping of each are left to the caller.
  void add(const SerialChain& chain, const TaskKinematics& kinematics,
           const ContactPointState& contact, const ScaledVector& inv_sqrt_weights,
           SpeedRows& rows) const noexcept;

 private:
  AttachedFrame link_;
  double cos_, sin_;
  double shift_m_;
};

}  // namespace tactus
