#include "tactus/control/body_distances.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tactus/math/pair.h"

namespace tactus {
namespace {

double lengthOf(const LinkCapsule& capsule) {
  return (capsule.p_LinkTo - capsule.p_LinkFrom).norm();
}

Segment axisInJoint(const LinkCapsule& capsule) {
  const double length_m = lengthOf(capsule);
  const Pose& X = capsule.link.X_JointFrame;
  const Vector3 direction =
      length_m > 0.0 ? Vector3(X.R_AB * (capsule.p_LinkTo - capsule.p_LinkFrom) / length_m)
                     : Vector3(Vector3::UnitX());
  return {X.p_AB + X.R_AB * capsule.p_LinkFrom, direction, length_m};
}

Vector3 middleOf(const Segment& segment) noexcept {
  return segment.p_Start + 0.5 * segment.length_m * segment.direction;
}

/// A vector as two of its components and the third one, which takes fewer instructions.
struct Coordinates {
  Pair xy;
  double z;
};
inline Coordinates operator+(Coordinates a, Coordinates b) { return {a.xy + b.xy, a.z + b.z}; }
inline Coordinates operator*(double a, Coordinates b) { return {a * b.xy, a * b.z}; }

inline void store(Coordinates v, Vector3& vector) {
  storePair(v.xy, vector.data());
  vector[2] = v.z;
}

/// R v, R by columns.
template <typename TwiceInPairs>
inline Coordinates turned(const double* R, const TwiceInPairs& v) {
  return {alignedPairAt(v.xx) * pairAt(R) + alignedPairAt(v.yy) * pairAt(R + 3) +
              alignedPairAt(v.zz) * pairAt(R + 6),
          v.xx[0] * R[2] + v.yy[0] * R[5] + v.zz[0] * R[8]};
}

inline Coordinates at(const JointPoints& points, int joint) {
  return {Pair{points.x[joint], points.y[joint]}, points.z[joint]};
}

NearBody& furthestOf(NearBodies& near) noexcept {
  NearBody* furthest = near.body.data();
  for (NearBody& body : near.body)
    if (body.distance_m > furthest->distance_m) furthest = &body;
  return *furthest;
}

/// The place for one more at this distance; null if it is out of reach, or if the list is full of
/// nearer ones.
NearBody* placeFor(double distance_m, double reach_m, NearBodies& near) noexcept {
  NearBody* place = nullptr;
  double left_out_m = distance_m;
  if (distance_m <= reach_m) {
    if (near.size < kMaxNearBodies) return &near.body[near.size++];
    NearBody& furthest = furthestOf(near);
    if (furthest.distance_m > distance_m) {
      place = &furthest;
      left_out_m = furthest.distance_m;
    }
  }
  near.beyond_m = std::min(near.beyond_m, left_out_m);
  return place;
}

/// A point of an axis, and what of the other one is nearest to it.
NearBody bodyAt(const Segment& axis, double position_m, const Segment& other, double radii_m,
                int index) noexcept {
  const Vector3 p_Axis = axis.p_Start + position_m * axis.direction;
  const ClosestPoints closest = closestPoints(other, p_Axis);
  return {index, closest.distance_m - radii_m, -closest.normal, p_Axis};
}

}  // namespace

BodyDistances::BodyDistances(const SerialChain& chain, const ClearanceConfig& config)
    : chain_(chain) {
  std::vector<int> places(config.capsules.size());
  for (const bool moves : {true, false}) {
    for (std::size_t i = 0; i < config.capsules.size(); ++i) {
      const LinkCapsule& capsule = config.capsules[i];
      if ((capsule.link.joint >= 0) != moves) continue;
      places[i] = static_cast<int>(capsules_.size());
      const Segment axis = axisInJoint(capsule);
      capsules_.push_back({capsule.link.joint, axis, middleOf(axis), capsule.radius_m});
    }
    if (moves) moving_ = static_cast<int>(capsules_.size());
  }
  const auto twice = [](const Vector3& v) {
    return TwiceInPairs{{v[0], v[0]}, {v[1], v[1]}, {v[2], v[2]}};
  };
  for (int i = 0; i < moving_; ++i) {
    directions_.push_back(twice(capsules_[i].axis.direction));
    starts_.push_back(twice(capsules_[i].axis.p_Start));
  }
  if (moving_ > kMaxMovingCapsules || static_cast<int>(capsules_.size()) > kMaxCapsules)
    throw std::invalid_argument("too many capsules");
  for (const CapsulePair& pair : config.pairs) {
    int a = places[pair.capsule];
    int b = places[pair.other];
    if (capsules_[a].joint == capsules_[b].joint)
      throw std::invalid_argument("nothing moves between two capsules");
    if (capsules_[a].joint < capsules_[b].joint) std::swap(a, b);
    pairs_.push_back({a, b, capsules_[a].radius_m + capsules_[b].radius_m});
  }
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const CapsulesApart& pair = pairs_[i];
    const double lengths_m =
        capsules_[pair.capsule].axis.length_m + capsules_[pair.other].axis.length_m;
    if (i % 2 == 0) balls_.push_back({{}, {}, {-kNoLimit, -kNoLimit}});
    BallsApart& balls = balls_.back();
    balls.capsule[i % 2] = pair.capsule;
    balls.other[i % 2] = pair.other;
    balls.radii_m[i % 2] = 0.5 * lengths_m + pair.radii_m;
  }
  for (const WallPair& pair : config.wall_pairs) {
    const int capsule = places[pair.capsule];
    if (capsule >= moving_) throw std::invalid_argument("nothing moves between wall and capsule");
    walls_.push_back({capsule, config.walls[pair.wall]});
  }
}

Segment BodyDistances::place(const Capsule& capsule, const ChainPose& pose) noexcept {
  return {pointInBase(pose, capsule.joint, capsule.axis.p_Start),
          vectorInBase(pose, capsule.joint, capsule.axis.direction), capsule.axis.length_m};
}

double BodyDistances::distance_m(const ChainPose& pose, int index) const noexcept {
  const auto pairs = static_cast<int>(pairs_.size());
  if (index < pairs) {
    const CapsulesApart& pair = pairs_[index];
    const Segment other = place(capsules_[pair.other], pose);
    return closestPoints(place(capsules_[pair.capsule], pose), other).distance_m - pair.radii_m;
  }
  const CapsuleAtWall& wall = walls_[index - pairs];
  const Capsule& capsule = capsules_[wall.capsule];
  return closestPoints(place(capsule, pose), wall.half_space).distance_m - capsule.radius_m;
}

NearStretch BodyDistances::stretch(const ChainPose& pose, const NearBody& near) const noexcept {
  constexpr double kNotParallel = 0.2;  ///< sine of the angle
  if (near.index >= static_cast<int>(pairs_.size())) return {0.0, {}};
  const CapsulesApart& pair = pairs_[near.index];
  const Segment axis = place(capsules_[pair.capsule], pose);
  const Segment other = place(capsules_[pair.other], pose);
  const double sine = axis.direction.cross(other.direction).norm() / kNotParallel;
  if (!(sine < 1.0)) return {0.0, {}};
  const Stretch beside = stretchBeside(axis, other);
  const double share = (1.0 - sine * sine) * (1.0 - sine * sine);
  return {share,
          {bodyAt(axis, beside.from_m, other, pair.radii_m, near.index),
           bodyAt(axis, beside.to_m, other, pair.radii_m, near.index)}};
}

void BodyDistances::placeAll(const ChainPose& pose, Placed& placed) const noexcept {
  for (int i = 0; i < moving_; ++i) {
    const Capsule& capsule = capsules_[i];
    const double* const R = pose.R_BaseJoint[capsule.joint].data();
    const Coordinates direction = turned(R, directions_[i]);
    const Coordinates start = turned(R, starts_[i]) + at(pose.p_BaseJoint, capsule.joint);
    const Coordinates middle = start + 0.5 * capsule.axis.length_m * direction;
    placed.axis[i].length_m = capsule.axis.length_m;
    store(direction, placed.axis[i].direction);
    store(start, placed.axis[i].p_Start);
    placed.x_Middle[i] = middle.xy[0];
    placed.y_Middle[i] = middle.xy[1];
    placed.z_Middle[i] = middle.z;
  }
  for (int i = moving_; i < static_cast<int>(capsules_.size()); ++i) {
    const Vector3& p_Middle = capsules_[i].p_Middle;
    placed.x_Middle[i] = p_Middle[0];
    placed.y_Middle[i] = p_Middle[1];
    placed.z_Middle[i] = p_Middle[2];
  }
}

void BodyDistances::findNear(const ChainPose& pose, double reach_m,
                             NearBodies& near) const noexcept {
  Placed placed;
  placeAll(pose, placed);
  near.size = 0;
  near.beyond_m = kNoLimit;
  Pair beyond_m = {kNoLimit, kNoLimit};
  int index = 0;
  for (const BallsApart& balls : balls_) {
    const auto between = [&balls](const std::array<double, kMaxCapsules>& middle) {
      return Pair{middle[balls.capsule[0]], middle[balls.capsule[1]]} -
             Pair{middle[balls.other[0]], middle[balls.other[1]]};
    };
    const Pair x = between(placed.x_Middle), y = between(placed.y_Middle),
               z = between(placed.z_Middle);
    Pair at_least_m = squareRoot(x * x + y * y + z * z) - alignedPairAt(balls.radii_m);
    const PairMask is_near = at_least_m <= reach_m;
    if (isAny(is_near)) {
      for (int k = 0; k < 2; ++k)
        if (is_near[k] != 0) tellOfPair(reach_m, placed, index + k, near);
      at_least_m = is_near ? Pair{kNoLimit, kNoLimit} : at_least_m;
    }
    beyond_m = smaller(beyond_m, at_least_m);
    index += 2;
  }
  near.beyond_m = std::min({near.beyond_m, beyond_m[0], beyond_m[1]});
  for (int i = 0; i < static_cast<int>(walls_.size()); ++i) tellOfWall(reach_m, placed, i, near);
}

void BodyDistances::tellOfPair(double reach_m, const Placed& placed, int index,
                               NearBodies& near) const noexcept {
  const CapsulesApart& pair = pairs_[index];
  const Segment& axis = placed.axis[pair.capsule];
  const Segment& other =
      pair.other < moving_ ? placed.axis[pair.other] : capsules_[pair.other].axis;
  const ClosestPoints closest = closestPoints(axis, other);
  const double distance_m = closest.distance_m - pair.radii_m;
  NearBody* const body = placeFor(distance_m, reach_m, near);
  if (!body) return;
  body->index = index;
  body->distance_m = distance_m;
  body->normal = closest.normal;
  body->p_Body = closest.p_Segment;
}

void BodyDistances::tellOfWall(double reach_m, const Placed& placed, int index,
                               NearBodies& near) const noexcept {
  const CapsuleAtWall& wall = walls_[index];
  const Capsule& capsule = capsules_[wall.capsule];
  const Segment& axis = placed.axis[wall.capsule];
  const Vector3& normal = wall.half_space.normal;
  const double first = normal.dot(axis.p_Start - wall.half_space.p_Surface) - capsule.radius_m;
  const int ends = axis.length_m > 0.0 ? 2 : 1;
  for (int end = 0; end < ends; ++end) {
    const double way_m = end == 0 ? 0.0 : axis.length_m;
    const double distance_m = first + way_m * normal.dot(axis.direction);
    NearBody* const body = placeFor(distance_m, reach_m, near);
    if (!body) continue;
    body->index = static_cast<int>(pairs_.size()) + index;
    body->distance_m = distance_m;
    body->normal = normal;
    body->p_Body = axis.p_Start + way_m * axis.direction;
  }
}

}  // namespace tactus
