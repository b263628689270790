#pragma once

#include "tactus/math/serial_chain.h"

namespace tactus {

/// A part of a link: all within radius_m of a segment, which may be a point.
struct LinkCapsule {
  AttachedFrame link;                    ///< joint -1: fixed to the base
  Vector3 p_LinkFrom = Vector3::Zero();  ///< m
  Vector3 p_LinkTo = Vector3::Zero();    ///< m
  double radius_m = 0.0;
};

}  // namespace tactus
