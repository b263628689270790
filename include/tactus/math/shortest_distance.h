#pragma once

#include "tactus/math/types.h"

/// Distances of a segment, as the axis of a capsule, from what it may meet. All in one frame, in m.
/// Lengths and places finite, directions unit vectors.
namespace tactus {

/// The points p_Start + s direction, 0 <= s <= length_m. Of length 0: a point.
struct Segment {
  Vector3 p_Start;
  Vector3 direction;
  double length_m;
};

/// The points p + t direction, from_m <= t <= to_m, either of which may be infinite: a segment, a
/// ray or a line.
struct Straight {
  Vector3 p;
  Vector3 direction;
  double from_m, to_m;
};

/// The points p with (p - p_Surface)^T normal <= 0.
struct HalfSpace {
  Vector3 p_Surface;
  Vector3 normal;  ///< out of it
};

/// The nearest points of a segment and another shape. Where the distance is differentiable, its
/// gradient with respect to a motion of the segment's point is `normal` (the envelope theorem).
struct ClosestPoints {
  double position_m;  ///< s of the segment's point
  Vector3 p_Segment;  ///< that point
  double distance_m;  ///< >= 0; from a half space negative inside
  Vector3 normal;  ///< unit vector from the other shape to the segment; across it where they meet
  bool is_beside;  ///< both points lie between the ends, so that the normal is across both
};

/// Of a segment that is nearly parallel to another one, from where to where it is beside it: as far
/// as the ends of the other, seen along it. One point where it is not.
struct Stretch {
  double from_m, to_m;
};

Stretch stretchBeside(const Segment& segment, const Straight& straight) noexcept;
Stretch stretchBeside(const Segment& segment, const Segment& other) noexcept;

/// Where several pairs of points are equally near, as with parallel lines, the middle one.
ClosestPoints closestPoints(const Segment& segment, const Vector3& point) noexcept;
ClosestPoints closestPoints(const Segment& segment, const Segment& other) noexcept;
ClosestPoints closestPoints(const Segment& segment, const Straight& straight) noexcept;
ClosestPoints closestPoints(const Segment& segment, const HalfSpace& half_space) noexcept;

}  // namespace tactus
