#include "tactus/math/serial_chain.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>

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

/// R * Rot(e_K, angle): turns two columns in their plane.
template <int K>
void rotateAboutCoordinateAxis(double sine, double cosine, Matrix3& R) {
  const Vector3 i = R.col((K + 1) % 3);
  const Vector3 j = R.col((K + 2) % 3);
  R.col((K + 1) % 3) = cosine * i + sine * j;
  R.col((K + 2) % 3) = cosine * j - sine * i;
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
    prepared.origin_is_rotated = joint.X_ParentJoint.R_AB != Matrix3::Identity();
    prepared.axis = joint.axis.normalized();
    prepared.coordinate_axis = coordinateAxis(joint.axis);
    prepared.axis_sign = joint.axis.sum() < 0.0 ? -1.0 : 1.0;
  }
}

void SerialChain::computePose(const JointVector& q, ChainPose& pose) const noexcept {
  double sine[kMaxJoints];
  double cosine[kMaxJoints];
  sinCos(q.data(), size_, sine, cosine);
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();
  for (int i = 0; i < size_; ++i) {
    const PreparedJoint& joint = joints_[i];
    p += R.lazyProduct(joint.p_ParentJoint);
    if (joint.origin_is_rotated) R = R.lazyProduct(joint.R_ParentJoint).eval();
    Vector3& axis = pose.axis_Base[i];
    if (joint.coordinate_axis < 0) {
      axis = R.lazyProduct(joint.axis);
    } else {
      axis = joint.axis_sign * R.col(joint.coordinate_axis);
    }
    if (joint.type == JointType::kPrismatic) {
      p += q[i] * axis;
    } else {
      switch (joint.coordinate_axis) {
        case 0:
          rotateAboutCoordinateAxis<0>(joint.axis_sign * sine[i], cosine[i], R);
          break;
        case 1:
          rotateAboutCoordinateAxis<1>(joint.axis_sign * sine[i], cosine[i], R);
          break;
        case 2:
          rotateAboutCoordinateAxis<2>(joint.axis_sign * sine[i], cosine[i], R);
          break;
        default:
          // With the constant axis of the joint's own frame: with the one in R, errors would grow.
          R = R.lazyProduct(rotationMatrix(joint.axis, sine[i], cosine[i])).eval();
      }
    }
    pose.R_BaseJoint[i] = R;
    pose.p_BaseJoint[i] = p;
  }
}

Pose framePose(const ChainPose& pose, const AttachedFrame& frame) noexcept {
  if (frame.joint < 0) return frame.X_JointFrame;
  return Pose{pose.R_BaseJoint[frame.joint], pose.p_BaseJoint[frame.joint]} * frame.X_JointFrame;
}

Vector3 vectorInBase(const ChainPose& pose, int joint, const Vector3& v_Joint) noexcept {
  return joint < 0 ? v_Joint : Vector3(pose.R_BaseJoint[joint].lazyProduct(v_Joint));
}

Vector3 pointInBase(const ChainPose& pose, int joint, const Vector3& p_JointPoint) noexcept {
  if (joint < 0) return p_JointPoint;
  return pose.p_BaseJoint[joint] + vectorInBase(pose, joint, p_JointPoint);
}

Vector3 framePosition(const ChainPose& pose, const AttachedFrame& frame) noexcept {
  return pointInBase(pose, frame.joint, frame.X_JointFrame.p_AB);
}

void computeTipJacobian(const SerialChain& chain, const ChainPose& pose, const Vector3& p_BaseTip,
                        const int* components, int component_count, TaskJacobian& J) noexcept {
  J.resize(component_count, chain.size());
  double unselected[kMaxJoints];
  double* row[6];  // where each of the six components goes
  std::fill(row, row + 6, &unselected[0]);
  bool has_rotation = false;
  for (int i = 0; i < component_count; ++i) {
    row[components[i]] = &J(i, 0);
    has_rotation = has_rotation || components[i] >= 3;
  }
  const int joints = chain.tip().joint + 1;
  for (int i = 0; i < joints; ++i) {
    const Vector3& axis = pose.axis_Base[i];
    const bool revolute = chain.type(i) == JointType::kRevolute;
    const Vector3 linear = revolute ? axis.cross(p_BaseTip - pose.p_BaseJoint[i]) : axis;
    row[0][i] = linear[0];
    row[1][i] = linear[1];
    row[2][i] = linear[2];
  }
  for (int i = 0; has_rotation && i < joints; ++i) {
    const bool revolute = chain.type(i) == JointType::kRevolute;
    for (int k = 0; k < 3; ++k) row[3 + k][i] = revolute ? pose.axis_Base[i][k] : 0.0;
  }
  if (joints < chain.size()) J.rightCols(chain.size() - joints).setZero();
}

void applyPointJacobianTranspose(const SerialChain& chain, const ChainPose& pose, int joint,
                                 const Vector3& p_BasePoint, const Vector3& f_Base,
                                 JointVector& result) noexcept {
  result.resize(chain.size());
  for (int i = 0; i < chain.size(); ++i) {
    if (i > joint) {
      result[i] = 0.0;
    } else if (chain.type(i) == JointType::kPrismatic) {
      result[i] = pose.axis_Base[i].dot(f_Base);
    } else {
      // (axis x r) . f = axis . (r x f)
      result[i] = pose.axis_Base[i].dot((p_BasePoint - pose.p_BaseJoint[i]).cross(f_Base));
    }
  }
}

}  // namespace tactus
