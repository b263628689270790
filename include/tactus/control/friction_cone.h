#pragma once

#include "tactus/control/contact_point.h"
#include "tactus/control/controller_config.h"
#include "tactus/control/speed_rows.h"

namespace tactus {

/// From one place to another along a module's x, m.
struct CoverPart {
  double from_m, to_m;
};

// clang-format off: equations
/// The contacts that a sensed force may come from, where friction of up to mu_max tilts it: four
/// corners, whose approach is limited one by one,
///   a_jk = J(x + k mu_max r)^T Rot(u, j atan mu_max) F^,     j, k = +1, -1
/// u: the link's axis; r: the cover's radius; x, F^: point and direction as sensed. Every normal
/// within atan mu_max of F^ is a positive combination of the two edges, so whatever F^ says of it,
/// and however late, its approach is limited too. Where contacts may be on more than one place,
/// their part of the cover takes that of x +- mu_max r: speeds are linear in x. The friction along
/// the axis is not felt, but shifts x = M / F by up to mu r. Derived in
/// docs/approach_speed_limit.md.
// clang-format on
class FrictionCone {
 public:
  FrictionCone(const TactileModuleConfig& module, double friction_coefficient);

  double cosine() const noexcept { return cos_; }  ///< of atan mu_max

  /// Where the contacts behind forces that act on a part of the cover may be.
  CoverPart around(const CoverPart& part) const noexcept {
    return {part.from_m - shift_m_, part.to_m + shift_m_};
  }

  /// Adds four rows, two at each end of `part`; direction: F^, module frame. Speed and damping of
  /// each are left to the caller.
  void add(const SerialChain& chain, const TaskKinematics& kinematics, const Vector3& direction,
           const CoverPart& part, const ScaledVector& inv_sqrt_weights,
           SpeedRows& rows) const noexcept;

 private:
  AttachedFrame link_;
  double cos_, sin_;
  double shift_m_;
};

}  // namespace tactus
