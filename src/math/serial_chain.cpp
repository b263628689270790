#include "tactus/math/serial_chain.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>

#include "tactus/math/pair.h"
#include "tactus/math/rotation.h"
#include "tactus/math/sin_cos.h"

namespace tactus {
namespace {

constexpr double kUnitTolerance = 1e-9;

bool isRigid(const Pose& X) {
  return (X.R_AB * X.R_AB.transpose()).isIdentity(kUnitTolerance) && X.R_AB.determinant() > 0.0 &&
         X.p_AB.allFinite();
}

/// 0, 1, 2 where the axis is +-x, y, z to the bit, -1 otherwise.
int coordinateAxis(const Vector3& axis) {
  for (int k = 0; k < 3; ++k) {
    if (axis == Vector3::Unit(k) || axis == -Vector3::Unit(k)) return k;
  }
  return -1;
}

/// 0, 1, 2 where a point lies on the x, y, z axis, -1 otherwise.
int axisOf(const Vector3& p) {
  for (int k = 0; k < 3; ++k) {
    if (p[(k + 1) % 3] == 0.0 && p[(k + 2) % 3] == 0.0) return k;
  }
  return -1;
}

/// A vector whose first two numbers share a register.
struct Column {
  Pair xy;
  double z;
};

inline Column operator*(double factor, Column v) { return {factor * v.xy, factor * v.z}; }
inline Column operator+(Column a, Column b) { return {a.xy + b.xy, a.z + b.z}; }
inline Column operator-(Column a, Column b) { return {a.xy - b.xy, a.z - b.z}; }

inline Column column(const Vector3& v) { return {pairAt(v.data()), v[2]}; }

inline void store(Column v, double* xyz) {
  storePair(v.xy, xyz);
  xyz[2] = v.z;
}

inline void store(Column v, int joint, JointPoints& points) {
  points.x[joint] = v.xy[0];
  points.y[joint] = v.xy[1];
  points.z[joint] = v.z;
}

/// A rotation by its columns, apart from each other, so that they stay in registers.
struct Columns {
  Column x, y, z;
};

inline void store(Columns R, Matrix3& matrix) {
  store(R.x, matrix.data());
  store(R.y, matrix.data() + 3);
  store(R.z, matrix.data() + 6);
}

/// Turns the axes i and j of a frame in their plane: R * Rot(k, angle).
inline void turn(double sine, double cosine, Column& i, Column& j) {
  const Column before = i;
  i = cosine * before + sine * j;
  j = cosine * j - sine * before;
}

Column generalProduct(Columns R, const Vector3& v) {
  Matrix3 matrix;
  store(R, matrix);
  return column(matrix.lazyProduct(v));
}

/// R v, where v may lie on a coordinate axis: 0, 1, 2, or else -1.
inline Column product(Columns R, const Vector3& v, int coordinate_axis) {
  switch (coordinate_axis) {
    case 0:
      return v[0] * R.x;
    case 1:
      return v[1] * R.y;
    case 2:
      return v[2] * R.z;
    default:
      return generalProduct(R, v);
  }
}

Columns product(Columns R, const Matrix3& rotation) {
  Matrix3 matrix;
  store(R, matrix);
  const Matrix3 result = matrix.lazyProduct(rotation);
  return {column(result.col(0)), column(result.col(1)), column(result.col(2))};
}

}  // namespace

SerialChain::SerialChain(const std::vector<Joint>& joints, const AttachedFrame& tip)
    : size_(static_cast<int>(joints.size())), tip_(tip) {
  if (size_ < 2 || size_ > kMaxJoints) throw std::invalid_argument("2 to 16 moving joints needed");
  if (tip.joint < -1 || tip.joint >= size_ || !isRigid(tip.X_JointFrame))
    throw std::invalid_argument("tip frame is not attached to the chain by a rigid pose");
  for (int i = 0; i < size_; ++i) {
    const Joint& joint = joints[i];
    if (!(std::abs(joint.axis.norm() - 1.0) <= kUnitTolerance))
      throw std::invalid_argument("joint axis is not a unit vector");
    if (!isRigid(joint.X_ParentJoint))
      throw std::invalid_argument("joint origin is not a rigid pose");
    PreparedJoint& prepared = joints_[i];
    prepared.type = joint.type;
    prepared.R_ParentJoint = joint.X_ParentJoint.R_AB;
    prepared.p_ParentJoint = joint.X_ParentJoint.p_AB;
    prepared.origin_axis = axisOf(joint.X_ParentJoint.p_AB);
    prepared.origin_is_rotated = joint.X_ParentJoint.R_AB != Matrix3::Identity();
    prepared.axis = joint.axis.normalized();
    prepared.coordinate_axis = coordinateAxis(joint.axis);
    prepared.axis_sign = joint.axis.sum() < 0.0 ? -1.0 : 1.0;
    if (joint.type == JointType::kPrismatic) prismatic_[prismatic_count_++] = i;
  }
  while (first_revolute_ < size_ && type(first_revolute_) == JointType::kPrismatic)
    ++first_revolute_;
}

void SerialChain::computePose(const JointVector& q, ChainPose& pose) const noexcept {
  double sine[kMaxJoints];
  double cosine[kMaxJoints];
  const int first = first_revolute_;
  sinCos(q.data() + first, size_ - first, sine + first, cosine + first);
  Columns R{{{1.0, 0.0}, 0.0}, {{0.0, 1.0}, 0.0}, {{0.0, 0.0}, 1.0}};
  const Column zero{{0.0, 0.0}, 0.0};
  Column p = zero;
  for (int i = 0; i < size_; ++i) {
    const PreparedJoint& joint = joints_[i];
    p = p + product(R, joint.p_ParentJoint, joint.origin_axis);
    if (joint.origin_is_rotated) R = product(R, joint.R_ParentJoint);
    const bool revolute = joint.type == JointType::kRevolute;
    Column axis;
    switch (joint.coordinate_axis) {
      case 0:
        axis = joint.axis_sign * R.x;
        if (revolute) turn(joint.axis_sign * sine[i], cosine[i], R.y, R.z);
        break;
      case 1:
        axis = joint.axis_sign * R.y;
        if (revolute) turn(joint.axis_sign * sine[i], cosine[i], R.z, R.x);
        break;
      case 2:
        axis = joint.axis_sign * R.z;
        if (revolute) turn(joint.axis_sign * sine[i], cosine[i], R.x, R.y);
        break;
      default:
        axis = generalProduct(R, joint.axis);
        // With the constant axis of the joint's own frame: with the one in R, errors would grow.
        if (revolute) R = product(R, rotationMatrix(joint.axis, sine[i], cosine[i]));
    }
    if (!revolute) p = p + q[i] * axis;
    store(R, pose.R_BaseJoint[i]);
    store(p, i, pose.p_BaseJoint);
    store(axis, i, pose.axis_Base);
  }
  if (size_ < kMaxJoints) {
    store(zero, size_, pose.p_BaseJoint);
    store(zero, size_, pose.axis_Base);
  }
}

Pose framePose(const ChainPose& pose, const AttachedFrame& frame) noexcept {
  if (frame.joint < 0) return frame.X_JointFrame;
  return Pose{pose.R_BaseJoint[frame.joint], pose.p_BaseJoint[frame.joint]} * frame.X_JointFrame;
}

Vector3 framePosition(const ChainPose& pose, const AttachedFrame& frame) noexcept {
  return pointInBase(pose, frame.joint, frame.X_JointFrame.p_AB);
}

}  // namespace tactus
