#include "tactus/math/shortest_distance.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace tactus {
namespace {

constexpr double kParallel = 1e-10;   ///< sine of the angle below which lines are
constexpr double kTouching_m = 1e-9;  ///< below it a difference of points has no direction

Vector3 anyVectorAcross(const Vector3& direction) noexcept {
  Eigen::Index smallest;
  direction.cwiseAbs().minCoeff(&smallest);
  return direction.cross(Vector3::Unit(smallest)).normalized();
}

Vector3 pointAt(const Segment& segment, double position_m) noexcept {
  return segment.p_Start + position_m * segment.direction;
}

bool isBetween(double x, double low, double high) noexcept { return x > low && x < high; }

/// `across`: gives the normal where the points are one.
template <typename Across>
ClosestPoints pairOf(const Segment& segment, double position_m, const Vector3& p_Other,
                     const Across& across) noexcept {
  const Vector3 p_Segment = pointAt(segment, position_m);
  const Vector3 between = p_Segment - p_Other;
  const double distance_m = between.norm();
  const Vector3 normal = distance_m < kTouching_m ? across() : Vector3(between / distance_m);
  return {position_m, p_Segment, distance_m, normal, isBetween(position_m, 0.0, segment.length_m)};
}

/// Positions along both, s and t, of the nearest points of skew lines, each kept to its range.
struct Positions {
  double s, t;
};

[[gnu::always_inline]] inline Positions nearestOfSkew(const Segment& a, const Straight& b,
                                                      double cosine, double sine_squared) noexcept {
  const Vector3 between = a.p_Start - b.p;
  const double along_a = a.direction.dot(between);
  const double along_b = b.direction.dot(between);
  const double s = std::clamp((cosine * along_b - along_a) / sine_squared, 0.0, a.length_m);
  const double t = cosine * s + along_b;
  if (t >= b.from_m && t <= b.to_m) return {s, t};
  const double t_end = std::clamp(t, b.from_m, b.to_m);
  return {std::clamp(cosine * t_end - along_a, 0.0, a.length_m), t_end};
}

/// The middle of the stretch where parallels are beside each other.
Positions middleOfParallels(const Segment& a, const Straight& b, double cosine) noexcept {
  const Stretch beside = stretchBeside(a, b);
  const double s = 0.5 * (beside.from_m + beside.to_m);
  const double t = (cosine < 0.0 ? -1.0 : 1.0) * (s - a.direction.dot(b.p - a.p_Start));
  return {s, std::clamp(t, b.from_m, b.to_m)};
}

[[gnu::always_inline]] inline ClosestPoints closestTo(const Straight& straight,
                                                      const Segment& segment) noexcept {
  const Vector3 across = segment.direction.cross(straight.direction);
  const double sine = across.norm();
  const double cosine = segment.direction.dot(straight.direction);
  const bool is_parallel = sine < kParallel;
  const Positions at = is_parallel ? middleOfParallels(segment, straight, cosine)
                                   : nearestOfSkew(segment, straight, cosine, sine * sine);
  ClosestPoints closest =
      pairOf(segment, at.s, straight.p + at.t * straight.direction, [&]() -> Vector3 {
        return is_parallel ? anyVectorAcross(segment.direction) : Vector3(across / sine);
      });
  closest.is_beside &= isBetween(at.t, straight.from_m, straight.to_m);
  return closest;
}

Straight straightOf(const Segment& segment) noexcept {
  return {segment.p_Start, segment.direction, 0.0, segment.length_m};
}

}  // namespace

Stretch stretchBeside(const Segment& segment, const Straight& straight) noexcept {
  const double sign = segment.direction.dot(straight.direction) < 0.0 ? -1.0 : 1.0;
  const double start = segment.direction.dot(straight.p - segment.p_Start);
  const double one = start + sign * straight.from_m;
  const double other = start + sign * straight.to_m;
  return {std::clamp(std::min(one, other), 0.0, segment.length_m),
          std::clamp(std::max(one, other), 0.0, segment.length_m)};
}

Stretch stretchBeside(const Segment& segment, const Segment& other) noexcept {
  return stretchBeside(segment, straightOf(other));
}

ClosestPoints closestPoints(const Segment& segment, const Vector3& point) noexcept {
  const double along = segment.direction.dot(point - segment.p_Start);
  return pairOf(segment, std::clamp(along, 0.0, segment.length_m), point,
                [&] { return anyVectorAcross(segment.direction); });
}

ClosestPoints closestPoints(const Segment& segment, const Segment& other) noexcept {
  return closestTo(straightOf(other), segment);
}

ClosestPoints closestPoints(const Segment& segment, const Straight& straight) noexcept {
  return closestTo(straight, segment);
}

ClosestPoints closestPoints(const Segment& segment, const HalfSpace& half_space) noexcept {
  const double rise = segment.direction.dot(half_space.normal);
  double position_m = rise > 0.0 ? 0.0 : segment.length_m;
  if (std::abs(rise) < kParallel) position_m = 0.5 * segment.length_m;
  const Vector3 p_Segment = pointAt(segment, position_m);
  const double distance_m = half_space.normal.dot(p_Segment - half_space.p_Surface);
  return {position_m, p_Segment, distance_m, half_space.normal, false};
}

}  // namespace tactus
