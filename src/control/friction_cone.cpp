#include "tactus/control/friction_cone.h"

#include <cmath>

namespace tactus {

FrictionCone::FrictionCone(const TactileModuleConfig& module, double friction_coefficient)
    : link_(module.link),
      cos_(1.0 / std::hypot(1.0, friction_coefficient)),
      sin_(friction_coefficient * cos_),
      shift_m_(friction_coefficient * module.cover_radius_m) {}

void FrictionCone::add(const SerialChain& chain, const TaskKinematics& kinematics,
                       const Vector3& direction, const CoverPart& part,
                       const ScaledVector& inv_sqrt_weights, SpeedRows& rows) const noexcept {
  const Pose X_BaseModule = framePose(kinematics.pose, link_);
  const Vector3 axis = X_BaseModule.R_AB.col(0);
  const Vector3 F_Base = X_BaseModule.R_AB.lazyProduct(direction);
  const Vector3 turned = axis.cross(F_Base);
  for (int i = 0; i < 4; ++i) {
    const double x_m = i < 2 ? part.to_m : part.from_m;
    const double sine = i % 2 == 0 ? sin_ : -sin_;
    ScaledVector a;
    applyPointJacobianTranspose(chain, kinematics.pose, link_.joint, X_BaseModule.p_AB + x_m * axis,
                                cos_ * F_Base + sine * turned, a);
    SpeedRow& row = rows.row[rows.size++];
    row.a_scaled = inv_sqrt_weights.cwiseProduct(a);
    row.a_task = kinematics.pseudoinverse.project(row.a_scaled);
  }
}

}  // namespace tactus
