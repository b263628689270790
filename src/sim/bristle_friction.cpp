#include "tactus/sim/bristle_friction.h"

namespace tactus {

Vector3 BristleFriction::update(const Vector3& slide_m, const Vector3& normal,
                                double normal_force_N) noexcept {
  stretch_m_ += slide_m;
  stretch_m_ -= stretch_m_.dot(normal) * normal;  // also where the normal has turned
  const double most_m = coefficient_ * normal_force_N / stiffness_N_per_m_;
  const double length_m = stretch_m_.norm();
  if (length_m > most_m) stretch_m_ *= most_m / length_m;
  return -stiffness_N_per_m_ * stretch_m_;
}

}  // namespace tactus
