#include <Eigen/Geometry>
#include <algorithm>

#include "tactus/control/body_distances.h"
#include "tactus/math/pair.h"

/// What a motion does to distances.
namespace tactus {

/// Joints before both capsules move neither against the other.
MovingJoints BodyDistances::movingJoints(const NearBody& near) const noexcept {
  const auto pairs = static_cast<int>(pairs_.size());
  if (near.index >= pairs) return {0, capsules_[walls_[near.index - pairs].capsule].joint + 1};
  const CapsulesApart& pair = pairs_[near.index];
  return {capsules_[pair.other].joint + 1, capsules_[pair.capsule].joint + 1};
}

/// z^T (r x n) of a revolute joint's axis z, r from the joint to the point; two joints at a time.
ScaledVector BodyDistances::gradient(const ChainPose& pose, const NearBody& near) const noexcept {
  const MovingJoints joints = movingJoints(near);
  ScaledVector gradient = ScaledVector::Zero();
  const double n_x = near.normal[0], n_y = near.normal[1], n_z = near.normal[2];
  const double p_x = near.p_Body[0], p_y = near.p_Body[1], p_z = near.p_Body[2];
  const int begin = joints.begin / 2 * 2;
  for (int i = begin; i < joints.end; i += 2) {
    const Pair r_x = p_x - alignedPairAt(pose.p_BaseJoint.x + i);
    const Pair r_y = p_y - alignedPairAt(pose.p_BaseJoint.y + i);
    const Pair r_z = p_z - alignedPairAt(pose.p_BaseJoint.z + i);
    storePair(alignedPairAt(pose.axis_Base.x + i) * (r_y * n_z - r_z * n_y) +
                  alignedPairAt(pose.axis_Base.y + i) * (r_z * n_x - r_x * n_z) +
                  alignedPairAt(pose.axis_Base.z + i) * (r_x * n_y - r_y * n_x),
              gradient.data() + i);
  }
  for (const int i : chain_.prismaticJoints()) {
    if (i >= joints.end) break;
    if (i >= joints.begin) gradient[i] = pose.axis_Base[i].dot(near.normal);
  }
  // What the first and the last pair had too many.
  if (begin < joints.begin) gradient[begin] = 0.0;
  if (joints.end < kMaxJoints) gradient[joints.end] = 0.0;
  return gradient;
}

/// A point p of the capsule moves by turn x p + shift against the other.
double BodyDistances::leftAfter_m(const ChainPose& pose, const NearBody& near, double time_s,
                                  const JointVector& velocity) const noexcept {
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
    const Vector3 moved = time_s * velocity[i] * pose.axis_Base[i];
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
