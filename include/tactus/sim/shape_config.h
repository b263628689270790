#pragma once

#include "tactus/math/types.h"

/// Shapes of obstacles in the base frame. Directions may have any length but zero.
namespace tactus {

struct SphereConfig {
  Vector3 center_m = Vector3::Zero();
  double radius_m = 0.0;
};

/// All that lies behind a plane.
struct PlaneConfig {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitZ();  ///< out of the obstacle
};

/// Endless in both directions, without thickness.
struct LineConfig {
  Vector3 point_m = Vector3::Zero();
  Vector3 direction = Vector3::UnitZ();
};

/// A round bar with round ends: all within radius_m of the straight from its foot to its head.
struct PostConfig {
  Vector3 foot_m = Vector3::Zero();
  Vector3 axis = Vector3::UnitZ();
  double height_m = 0.0;
  double radius_m = 0.0;
};

}  // namespace tactus
