#pragma once

#include "tactus/control/tactile_channels.h"
#include "tactus/math/types.h"

namespace tactus {

/// What hangs on the cells of a tactile module beside contacts: its cover, as a point.
struct CoverConfig {
  double mass_kg = 0.0;
  Vector3 p_ModuleCenter = Vector3::Zero();  ///< its centre of mass, module frame, m
};

/// m R^T (g - a) at the centre of mass: what the cells feel of the cover's weight and inertia.
/// load_Base: g - a of that centre, base frame, m/s^2.
inline Wrench5 coverLoad(const CoverConfig& cover, const Matrix3& R_BaseModule,
                         const Vector3& load_Base) noexcept {
  const Vector3 F = cover.mass_kg * (R_BaseModule.transpose() * load_Base);
  const Vector3& p = cover.p_ModuleCenter;
  return Wrench5{{F.y(), F.z(), p.z() * F.x() - p.x() * F.z(), p.x() * F.y() - p.y() * F.x(),
                  p.y() * F.z() - p.z() * F.y()}};
}

}  // namespace tactus
