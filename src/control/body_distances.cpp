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

Straight straightOf(const Segment& segment) noexcept {
  return {segment.p_Start, segment.direction, 0.0, segment.length_m};
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
inline Coordinates turned(const double* R, const Vector3& v) {
  const auto column = [R](int i) { return Coordinates{pairAt(R + 3 * i), R[3 * i + 2]}; };
  return v[0] * column(0) + v[1] * column(1) + v[2] * column(2);
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
  if (moving_ > kMaxMovingCapsules || static_cast<int>(capsules_.size()) > kMaxCapsules)
    throw std::invalid_argument("too many capsules");
  for (const CapsulePair& pair : config.pairs) {
    int a = places[pair.capsule];
    int b = places[pair.other];
    if (capsules_[a].joint == capsules_[b].joint)
      throw std::invalid_argument("nothing moves between two capsules");
    if (capsules_[a].joint < capsules_[b].joint) std::swap(a, b);
    const double radii_m = capsules_[a].radius_m + capsules_[b].radius_m;
    const double halves_m = 0.5 * (capsules_[a].axis.length_m + capsules_[b].axis.length_m);
    pairs_.push_back({a, b, halves_m + radii_m, radii_m});
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
    return closestPoints(place(capsules_[pair.capsule], pose), straightOf(other)).distance_m -
           pair.radii_m;
  }
  const CapsuleAtWall& wall = walls_[index - pairs];
  const Capsule& capsule = capsules_[wall.capsule];
  return closestPoints(place(capsule, pose), wall.half_space).distance_m - capsule.radius_m;
}

void BodyDistances::findNear(const ChainPose& pose, double reach_m,
                             NearBodies& near) const noexcept {
  Placed placed;
  for (int i = 0; i < moving_; ++i) {
    const Capsule& capsule = capsules_[i];
    const double* const R = pose.R_BaseJoint[capsule.joint].data();
    const Coordinates direction = turned(R, capsule.axis.direction);
    const Coordinates start = turned(R, capsule.axis.p_Start) + at(pose.p_BaseJoint, capsule.joint);
    placed.axis[i].length_m = capsule.axis.length_m;
    store(direction, placed.axis[i].direction);
    store(start, placed.axis[i].p_Start);
    store(start + 0.5 * capsule.axis.length_m * direction, placed.p_Middle[i]);
  }
  for (int i = moving_; i < static_cast<int>(capsules_.size()); ++i)
    placed.p_Middle[i] = capsules_[i].p_Middle;
  near.size = 0;
  near.beyond_m = kNoLimit;
  double beyond_m = kNoLimit;
  int index = 0;
  for (const CapsulesApart& pair : pairs_) {
    const Vector3& p = placed.p_Middle[pair.capsule];
    const Vector3& p_Other = placed.p_Middle[pair.other];
    const double x = p[0] - p_Other[0], y = p[1] - p_Other[1], z = p[2] - p_Other[2];
    const double at_least_m = std::sqrt(x * x + y * y + z * z) - pair.bounds_m;
    if (at_least_m <= reach_m) {
      tellOfPair(pose, reach_m, placed, index, near);
    } else {
      beyond_m = std::min(beyond_m, at_least_m);
    }
    ++index;
  }
  near.beyond_m = std::min(near.beyond_m, beyond_m);
  for (int i = 0; i < static_cast<int>(walls_.size()); ++i)
    tellOfWall(pose, reach_m, placed, i, near);
}

void BodyDistances::tellOfPair(const ChainPose& pose, double reach_m, const Placed& placed,
                               int index, NearBodies& near) const noexcept {
  const CapsulesApart& pair = pairs_[index];
  const Segment& axis = placed.axis[pair.capsule];
  const Segment& other =
      pair.other < moving_ ? placed.axis[pair.other] : capsules_[pair.other].axis;
  const ClosestPoints closest = closestPoints(axis, straightOf(other));
  const double distance_m = closest.distance_m - pair.radii_m;
  NearBody* const body = placeFor(distance_m, reach_m, near);
  if (!body) return;
  body->index = index;
  body->distance_m = distance_m;
  body->normal = closest.normal;
  computeGradient(pose, capsules_[pair.capsule].joint, capsules_[pair.other].joint,
                  closest.p_Segment, *body);
}

void BodyDistances::tellOfWall(const ChainPose& pose, double reach_m, const Placed& placed,
                               int index, NearBodies& near) const noexcept {
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
    computeGradient(pose, capsule.joint, -1, axis.p_Start + way_m * axis.direction, *body);
  }
}

/// z^T (r x n) of a revolute joint's axis z, r from the joint to the point; two joints at a time.
/// The joints before both capsules move neither against the other.
void BodyDistances::computeGradient(const ChainPose& pose, int joint, int other_joint,
                                    const Vector3& p_Base, NearBody& near) const noexcept {
  double* const gradient = near.gradient.data();
  for (int i = 0; i < kMaxJoints; i += 2) storePair(Pair{0.0, 0.0}, gradient + i);
  const double n_x = near.normal[0], n_y = near.normal[1], n_z = near.normal[2];
  const double p_x = p_Base[0], p_y = p_Base[1], p_z = p_Base[2];
  const int begin = (other_joint + 1) / 2 * 2;
  for (int i = begin; i <= joint; i += 2) {
    const Pair r_x = p_x - alignedPairAt(pose.p_BaseJoint.x + i);
    const Pair r_y = p_y - alignedPairAt(pose.p_BaseJoint.y + i);
    const Pair r_z = p_z - alignedPairAt(pose.p_BaseJoint.z + i);
    storePair(alignedPairAt(pose.axis_Base.x + i) * (r_y * n_z - r_z * n_y) +
                  alignedPairAt(pose.axis_Base.y + i) * (r_z * n_x - r_x * n_z) +
                  alignedPairAt(pose.axis_Base.z + i) * (r_x * n_y - r_y * n_x),
              gradient + i);
  }
  for (const int i : chain_.prismaticJoints()) {
    if (i > joint) break;
    if (i > other_joint) gradient[i] = pose.axis_Base[i].dot(near.normal);
  }
  // What the first and the last pair had too many.
  if (begin == other_joint) gradient[begin] = 0.0;
  if (joint + 1 < kMaxJoints) gradient[joint + 1] = 0.0;
}

/// A point p of the capsule moves by turn x p + shift against the other.
double BodyDistances::leftAfter_m(const ChainPose& pose, const NearBody& near,
                                  const ScaledVector& step) const noexcept {
  const auto pairs = static_cast<int>(pairs_.size());
  const bool is_wall = near.index >= pairs;
  const int place_of = is_wall ? walls_[near.index - pairs].capsule : pairs_[near.index].capsule;
  const Capsule& capsule = capsules_[place_of];
  const Segment axis = place(capsule, pose);
  double level_m = capsule.radius_m;
  int other_joint = -1;
  if (is_wall) {
    level_m += near.normal.dot(walls_[near.index - pairs].half_space.p_Surface);
  } else {
    const Capsule& other = capsules_[pairs_[near.index].other];
    const Segment other_axis = place(other, pose);
    const double rise = other_axis.length_m * near.normal.dot(other_axis.direction);
    level_m += other.radius_m + near.normal.dot(other_axis.p_Start) + std::max(0.0, rise);
    other_joint = other.joint;
  }
  Vector3 turn = Vector3::Zero();
  Vector3 shift = Vector3::Zero();
  for (int i = other_joint + 1; i <= capsule.joint; ++i) {
    const Vector3 moved = step[i] * pose.axis_Base[i];
    if (chain_.type(i) == JointType::kPrismatic) {
      shift += moved;
    } else {
      turn += moved;
      shift += pose.p_BaseJoint[i].cross(moved);
    }
  }
  const Vector3 p_End = axis.p_Start + axis.length_m * axis.direction;
  return std::min(near.normal.dot(axis.p_Start + turn.cross(axis.p_Start) + shift),
                  near.normal.dot(p_End + turn.cross(p_End) + shift)) -
         level_m;
}

}  // namespace tactus
