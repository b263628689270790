#pragma once

#include "tactus/math/types.h"

namespace tactus {

/// Dry friction of one contact: a bristle between the surfaces sticks as a spring, and slips where
/// it would pull with more than mu times the normal force (Dahl's model of 1968 with exponent 0).
class BristleFriction {
 public:
  /// coefficient: mu >= 0; stiffness: of the bristle, finite, > 0.
  BristleFriction(double coefficient, double stiffness_N_per_m) noexcept
      : coefficient_(coefficient), stiffness_N_per_m_(stiffness_N_per_m) {}

  /// The force on the surface that slid by so much since the last call, N, in the frame of its
  /// arguments and across the normal, a unit vector.
  Vector3 update(const Vector3& slide_m, const Vector3& normal, double normal_force_N) noexcept;

  /// The surfaces part.
  void release() noexcept { stretch_m_.setZero(); }

 private:
  double coefficient_, stiffness_N_per_m_;
  Vector3 stretch_m_ = Vector3::Zero();  ///< of the bristle
};

}  // namespace tactus
