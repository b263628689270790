#pragma once

#include "tactus/control/cover_load.h"

namespace tactus {

/// The cover of a tactile module as its cells feel it: by its weight, and by the acceleration of
/// its material, the mean over a step of the module's filter. Where it turns by itself it has no
/// inertia.
class MovingCover {
 public:
  /// At rest at X_BaseModule. gravity_Base: m/s^2.
  MovingCover(const CoverConfig& cover, const Vector3& gravity_Base, const Pose& X_BaseModule)
      : cover_(cover),
        gravity_Base_(gravity_Base),
        p_Base_(X_BaseModule.p_AB + X_BaseModule.R_AB * cover.p_ModuleCenter),
        at_rest_(coverLoad(cover, X_BaseModule.R_AB, gravity_Base)) {}

  /// Where it rested at first.
  const Wrench5& atRest() const noexcept { return at_rest_; }

  /// What it adds to contacts, step_s > 0 after the last call.
  Wrench5 update(const Pose& X_BaseModule, double step_s) noexcept {
    const Vector3 p_Base = X_BaseModule.p_AB + X_BaseModule.R_AB * cover_.p_ModuleCenter;
    const Vector3 way_m = p_Base - p_Base_;
    const Vector3 a_Base = (way_m - way_before_m_) / (step_s * step_s);
    p_Base_ = p_Base;
    way_before_m_ = way_m;
    return coverLoad(cover_, X_BaseModule.R_AB, gravity_Base_ - a_Base);
  }

 private:
  CoverConfig cover_;
  Vector3 gravity_Base_;
  Vector3 p_Base_, way_before_m_ = Vector3::Zero();  ///< of its centre, in the last step
  Wrench5 at_rest_;
};

}  // namespace tactus
