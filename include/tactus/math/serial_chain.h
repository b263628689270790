#pragma once

#include <array>
#include <span>
#include <vector>

#include "tactus/math/types.h"

namespace tactus {

enum class JointType { kPrismatic, kRevolute };

/// Of a joint's position.
inline const char* unitOf(JointType type) noexcept {
  return type == JointType::kPrismatic ? "m" : "rad";
}

/// One moving joint of a robot description. At q = 0 the joint frame lies at X_ParentJoint in the
/// frame of the previous moving joint (of the base for the first); q moves it along or about
/// `axis`.
struct Joint {
  JointType type = JointType::kRevolute;
  Pose X_ParentJoint;               ///< fixed joints in between are already multiplied in
  Vector3 axis = Vector3::UnitZ();  ///< unit vector in the joint frame
};

/// A frame that moves with a joint: `joint` is the index of the last moving joint before it, -1 for
/// a frame fixed to the base.
struct AttachedFrame {
  int joint = -1;
  Pose X_JointFrame;
};

/// A vector a joint, one component of all joints beside the other: what is computed of every joint
/// takes two of them at a time.
struct JointPoints {
  alignas(16) double x[kMaxJoints], y[kMaxJoints], z[kMaxJoints];

  Vector3 operator[](int joint) const noexcept { return {x[joint], y[joint], z[joint]}; }
};

/// Where every joint frame of a chain is, in the base frame; scratch of one configuration. An odd
/// number of joints is followed by one that is zero.
struct ChainPose {
  std::array<Matrix3, kMaxJoints> R_BaseJoint;
  JointPoints p_BaseJoint;  ///< m
  JointPoints axis_Base;    ///< unit joint axes
};

/// The moving joints between the base and the tool, base first. A const model: everything that
/// changes with q lives in a ChainPose.
class SerialChain {
 public:
  /// Throws std::invalid_argument unless there are 2 to kMaxJoints joints with unit axes and
  /// orthonormal rotations.
  SerialChain(const std::vector<Joint>& joints, const AttachedFrame& tip);

  int size() const noexcept { return size_; }
  JointType type(int joint) const noexcept { return joints_[joint].type; }
  /// The joints that are prismatic, ascending.
  std::span<const int> prismaticJoints() const noexcept {
    return {prismatic_.data(), static_cast<std::size_t>(prismatic_count_)};
  }
  const AttachedFrame& tip() const noexcept { return tip_; }

  /// Forward kinematics: the pose of every joint frame at q (size() entries, finite).
  void computePose(const JointVector& q, ChainPose& pose) const noexcept;

 private:
  /// A joint prepared for the cycle: most axes are a coordinate axis, and most origins lie on one
  /// and are not rotated, which saves two thirds of the work.
  struct PreparedJoint {
    JointType type;
    bool origin_is_rotated;
    int origin_axis;  ///< 0, 1, 2 for an origin on the x, y, z axis of its parent; -1 for others
    int coordinate_axis;  ///< 0, 1, 2 for +-x, y, z; -1 for any other axis
    double axis_sign;
    Vector3 axis;
    Matrix3 R_ParentJoint;
    Vector3 p_ParentJoint;
  };

  int size_;
  int first_revolute_ = 0;  ///< the first joint whose sine is needed
  int prismatic_count_ = 0;
  std::array<int, kMaxJoints> prismatic_;
  std::array<PreparedJoint, kMaxJoints> joints_;
  AttachedFrame tip_;
};

/// Pose of an attached frame in the base frame.
Pose framePose(const ChainPose& pose, const AttachedFrame& frame) noexcept;

/// Of the tip with the joints at q, m or rad, in the base frame.
inline Pose tipPose(const SerialChain& chain, const JointVector& q) noexcept {
  ChainPose pose;
  chain.computePose(q, pose);
  return framePose(pose, chain.tip());
}

/// A point (m) or a free vector given in the frame of `joint` (-1: the base), in the base frame.
inline Vector3 vectorInBase(const ChainPose& pose, int joint, const Vector3& v_Joint) noexcept {
  return joint < 0 ? v_Joint : Vector3(pose.R_BaseJoint[joint].lazyProduct(v_Joint));
}
inline Vector3 pointInBase(const ChainPose& pose, int joint, const Vector3& p_JointPoint) noexcept {
  if (joint < 0) return p_JointPoint;
  return pose.p_BaseJoint[joint] + vectorInBase(pose, joint, p_JointPoint);
}

/// Position only, m: what framePose(pose, frame).p_AB would be.
Vector3 framePosition(const ChainPose& pose, const AttachedFrame& frame) noexcept;

/// Rows of the geometric Jacobian of the tip in the base frame, for `components` (0, 1, 2: linear
/// velocity x, y, z of the tip's origin; 3, 4, 5: angular velocity). J has one row a component.
void computeTipJacobian(const SerialChain& chain, const ChainPose& pose, const Vector3& p_BaseTip,
                        const int* components, int component_count, TaskJacobian& J) noexcept;

/// The same as W^-1/2 J^T, of which the first component_count columns are set. inv_sqrt_weights:
/// the diagonal of W^-1/2.
void computeTipJacobian(const SerialChain& chain, const ChainPose& pose, const Vector3& p_BaseTip,
                        const int* components, int component_count,
                        const ScaledVector& inv_sqrt_weights, ScaledJacobian& J) noexcept;

/// J_p^T f: the joint-space image of a vector f (base frame) acting at the point p_BasePoint (base
/// frame, m), which moves with `joint`. Joints beyond `joint` get zero. Equation (16) with f = F^.
void applyPointJacobianTranspose(const SerialChain& chain, const ChainPose& pose, int joint,
                                 const Vector3& p_BasePoint, const Vector3& f_Base,
                                 ScaledVector& result) noexcept;

}  // namespace tactus
