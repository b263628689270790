#include "tactus/control/body_distances.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tactus/math/pair.h"

namespace tactus {
namespace {

/// Both ends of a NearBody, or one.
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

/// The place for one more: of a full list that of the furthest, if it is further than that; else
/// null.
NearBody* placeFor(double distance_m, NearBodies& near) noexcept {
  if (near.size < kMaxNearBodies) return &near.body[near.size++];
  NearBody* furthest = near.body.data();
  for (NearBody& body : near.body)
    if (body.distance_m > furthest->distance_m) furthest = &body;
  if (furthest->distance_m <= distance_m) {
    near.beyond_m = std::min(near.beyond_m, distance_m);
    return nullptr;
  }
  near.beyond_m = std::min(near.beyond_m, furthest->distance_m);
  return furthest;
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
      capsules_.push_back({capsule.link.joint, axisInJoint(capsule), capsule.radius_m});
      if (!moves) p_FixedMiddle_.push_back(middleOf(capsules_.back().axis));
    }
    if (moves) moving_ = static_cast<int>(capsules_.size());
  }
  if (moving_ > kMaxMovingCapsules) throw std::invalid_argument("too many capsules that move");
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
    const Pair& pair = pairs_[index];
    const Segment other = place(capsules_[pair.other], pose);
    return closestPoints(place(capsules_[pair.capsule], pose), straightOf(other)).distance_m -
           pair.radii_m;
  }
  const Wall& wall = walls_[index - pairs];
  const Capsule& capsule = capsules_[wall.capsule];
  return closestPoints(place(capsule, pose), wall.half_space).distance_m - capsule.radius_m;
}

void BodyDistances::findNear(const ChainPose& pose, double reach_m,
                             NearBodies& near) const noexcept {
  Placed placed;
  for (int i = 0; i < moving_; ++i) {
    placed.axis[i] = place(capsules_[i], pose);
    placed.p_Middle[i] = middleOf(placed.axis[i]);
  }
  near.size = 0;
  near.beyond_m = kNoLimit;
  findNearPairs(pose, reach_m, placed, near);
  findNearWalls(pose, reach_m, placed, near);
}

void BodyDistances::findNearPairs(const ChainPose& pose, double reach_m, const Placed& placed,
                                  NearBodies& near) const noexcept {
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_[i];
    const bool is_fixed = pair.other >= moving_;
    const Vector3& p_Other =
        is_fixed ? p_FixedMiddle_[pair.other - moving_] : placed.p_Middle[pair.other];
    const double at_least_m = (placed.p_Middle[pair.capsule] - p_Other).norm() - pair.bounds_m;
    if (at_least_m > reach_m) {
      near.beyond_m = std::min(near.beyond_m, at_least_m);
      continue;
    }
    const Segment& axis = placed.axis[pair.capsule];
    const Segment& other = is_fixed ? capsules_[pair.other].axis : placed.axis[pair.other];
    const ClosestPoints closest = closestPoints(axis, straightOf(other));
    const double distance_m = closest.distance_m - pair.radii_m;
    NearBody* const body = distance_m > reach_m ? nullptr : placeFor(distance_m, near);
    if (!body) {
      near.beyond_m = std::min(near.beyond_m, distance_m);
      continue;
    }
    const double rise = axis.length_m * closest.normal.dot(axis.direction);
    const double highest = std::max(0.0, other.length_m * closest.normal.dot(other.direction));
    const double first = closest.normal.dot(axis.p_Start - other.p_Start) - highest - pair.radii_m;
    body->index = static_cast<int>(i);
    body->distance_m = distance_m;
    body->ends = axis.length_m > 0.0 ? 2 : 1;
    body->share = body->ends == 2 ? closest.position_m / axis.length_m : 0.0;
    body->height_m = {first, first + rise};
    computeGradients(pose, capsules_[pair.capsule].joint, capsules_[pair.other].joint, axis,
                     closest.normal, *body);
  }
}

void BodyDistances::findNearWalls(const ChainPose& pose, double reach_m, const Placed& placed,
                                  NearBodies& near) const noexcept {
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    const Wall& wall = walls_[i];
    const Capsule& capsule = capsules_[wall.capsule];
    const Segment& axis = placed.axis[wall.capsule];
    const Vector3& normal = wall.half_space.normal;
    const double first = normal.dot(axis.p_Start - wall.half_space.p_Surface) - capsule.radius_m;
    const int ends = axis.length_m > 0.0 ? 2 : 1;
    for (int end = 0; end < ends; ++end) {
      const double way_m = end == 0 ? 0.0 : axis.length_m;
      const double distance_m = first + way_m * normal.dot(axis.direction);
      NearBody* const body = distance_m > reach_m ? nullptr : placeFor(distance_m, near);
      if (!body) {
        near.beyond_m = std::min(near.beyond_m, distance_m);
        continue;
      }
      body->index = static_cast<int>(pairs_.size() + i);
      body->distance_m = distance_m;
      body->ends = 1;
      body->share = 0.0;
      body->height_m = {distance_m, distance_m};
      computeGradients(pose, capsule.joint, -1,
                       {axis.p_Start + way_m * axis.direction, axis.direction, 0.0}, normal, *body);
    }
  }
}

/// z^T (r x n) of a revolute joint's axis z, r from the joint to the end; two joints at a time. The
/// joints before both capsules move neither against the other.
void BodyDistances::computeGradients(const ChainPose& pose, int joint, int other_joint,
                                     const Segment& axis, const Vector3& normal,
                                     NearBody& near) const noexcept {
  ScaledVector& first = near.gradient[0];
  ScaledVector& second = near.gradient[1];
  first.setZero();
  const double n_x = normal[0], n_y = normal[1], n_z = normal[2];
  const Vector3& p = axis.p_Start;
  const Vector3 turn = axis.length_m * axis.direction.cross(normal);
  const double t_x = turn[0], t_y = turn[1], t_z = turn[2];
  if (near.ends == 2) second.setZero();
  for (int i = (other_joint + 1) / 2 * 2; i <= joint; i += 2) {
    const auto z_x = alignedPairAt(pose.axis_Base.x + i), z_y = alignedPairAt(pose.axis_Base.y + i),
               z_z = alignedPairAt(pose.axis_Base.z + i);
    const auto r_x = p[0] - alignedPairAt(pose.p_BaseJoint.x + i),
               r_y = p[1] - alignedPairAt(pose.p_BaseJoint.y + i),
               r_z = p[2] - alignedPairAt(pose.p_BaseJoint.z + i);
    const auto rise = z_x * (r_y * n_z - r_z * n_y) + z_y * (r_z * n_x - r_x * n_z) +
                      z_z * (r_x * n_y - r_y * n_x);
    storePair(rise, &first[i]);
    if (near.ends == 2) storePair(rise + (z_x * t_x + z_y * t_y + z_z * t_z), &second[i]);
  }
  for (const int i : chain_.prismaticJoints()) {
    if (i > joint) break;
    first[i] = second[i] = pose.axis_Base[i].dot(normal);
  }
  for (ScaledVector* gradient : {&first, &second}) {
    if (other_joint >= 0) gradient->head(other_joint + 1).setZero();
    if (joint + 1 < kMaxJoints) (*gradient)[joint + 1] = 0.0;
  }
}

}  // namespace tactus
