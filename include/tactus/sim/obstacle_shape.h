#pragma once

#include <optional>
#include <variant>

#include "tactus/math/shortest_distance.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// The axis of the cover as the world sees it.
struct CoverAxis {
  Vector3 p_BaseStart;  ///< m
  Vector3 direction;    ///< unit vector, base frame, start to end
  double length_m;
  double radius_m;
};

/// How deep an obstacle is in a cover, and where.
struct Meeting {
  double depth_m = 0.0;                   ///< <= 0: they do not touch
  double position_m = 0.0;                ///< along the axis
  Vector3 normal_Base = Vector3::Zero();  ///< unit vector from the obstacle to the axis
};

/// What an obstacle is, apart from its springs. Depth is that in a capsule, the cover with round
/// ends, whose change per motion is the normal, so that springs without friction keep energy. A
/// vertical line by x_m and y_m instead meets a cover that ends at the ends of its axis, and only
/// from the side. The side of lines, posts and spheres is fixed when they come beside the axis, and
/// until they leave over an end, so an arm pushed through more than its radius is still pushed
/// back.
class ObstacleShape {
 public:
  explicit ObstacleShape(const ObstacleConfig& config);

  /// With the obstacle shifted from its place.
  Meeting meet(const CoverAxis& axis, const Vector3& shift_m) noexcept;

 private:
  struct VerticalLine {
    double x_m, y_m;
    double side = 0.0;  ///< +-1 left or right of the axis; 0 while not beside the cover
  };
  struct Bar {
    Straight axis;
    double radius_m;
  };

  Meeting meet(VerticalLine& line, const CoverAxis& axis, const Vector3& shift_m) noexcept;
  Meeting meet(const SphereConfig& sphere, const CoverAxis& axis, const Vector3& shift_m) noexcept;
  Meeting meet(const Bar& bar, const CoverAxis& axis, const Vector3& shift_m) noexcept;
  Meeting meet(const HalfSpace& half_space, const CoverAxis& axis, const Vector3& shift_m) noexcept;
  Meeting onItsSide(const ClosestPoints& closest, double reach_m) noexcept;

  using Shape = std::variant<VerticalLine, SphereConfig, Bar, HalfSpace>;
  static Shape shapeOf(const ObstacleConfig& config);

  Shape shape_;
  std::optional<Vector3> normal_before_;  ///< while it is beside the axis
};

}  // namespace tactus
