#include <algorithm>

#include "tactus/math/pair.h"
#include "tactus/math/serial_chain.h"

namespace tactus {

void computeTipJacobian(const SerialChain& chain, const ChainPose& pose, const Vector3& p_BaseTip,
                        const int* components, int component_count,
                        const ScaledVector& inv_sqrt_weights, ScaledJacobian& J) noexcept {
  const int joints = chain.tip().joint + 1;
  ScaledVector unselected;
  double* column[6];  // where each of the six components goes
  std::fill(column, column + 6, unselected.data());
  bool has_rotation = false;
  for (int k = 0; k < component_count; ++k) {
    J.col(k).setZero();
    column[components[k]] = J.col(k).data();
    has_rotation = has_rotation || components[k] >= 3;
  }
  // As if all were revolute, two joints at a time: axis x (p_BaseTip - p_BaseJoint).
  const JointPoints& axis = pose.axis_Base;
  const double x_Tip = p_BaseTip[0], y_Tip = p_BaseTip[1], z_Tip = p_BaseTip[2];
  for (int i = 0; i < joints; i += 2) {
    const Pair scale = alignedPairAt(&inv_sqrt_weights[i]);
    const Pair a_x = alignedPairAt(axis.x + i), a_y = alignedPairAt(axis.y + i),
               a_z = alignedPairAt(axis.z + i);
    const Pair r_x = x_Tip - alignedPairAt(pose.p_BaseJoint.x + i);
    const Pair r_y = y_Tip - alignedPairAt(pose.p_BaseJoint.y + i);
    const Pair r_z = z_Tip - alignedPairAt(pose.p_BaseJoint.z + i);
    storePair(scale * (a_y * r_z - a_z * r_y), column[0] + i);
    storePair(scale * (a_z * r_x - a_x * r_z), column[1] + i);
    storePair(scale * (a_x * r_y - a_y * r_x), column[2] + i);
  }
  for (int i = 0; has_rotation && i < joints; ++i) {
    for (int k = 0; k < 3; ++k) column[3 + k][i] = inv_sqrt_weights[i] * axis[i][k];
  }
  for (const int i : chain.prismaticJoints()) {
    if (i >= joints) break;
    for (int k = 0; k < 3; ++k) column[k][i] = inv_sqrt_weights[i] * axis[i][k];
    for (int k = 3; k < 6; ++k) column[k][i] = 0.0;
  }
  if (joints % 2 == 1) {  // what the last pair had too many
    for (int k = 0; k < component_count; ++k) J(joints, k) = 0.0;
  }
}

void computeTipJacobian(const SerialChain& chain, const ChainPose& pose, const Vector3& p_BaseTip,
                        const int* components, int component_count, TaskJacobian& J) noexcept {
  ScaledJacobian columns;
  computeTipJacobian(chain, pose, p_BaseTip, components, component_count, ScaledVector::Ones(),
                     columns);
  J = columns.topLeftCorner(chain.size(), component_count).transpose();
}

void applyPointJacobianTranspose(const SerialChain& chain, const ChainPose& pose, int joint,
                                 const Vector3& p_BasePoint, const Vector3& f_Base,
                                 ScaledVector& result) noexcept {
  const int joints = joint + 1;
  result.setZero();
  // As if all were revolute, two joints at a time: (axis x r) . f = axis . (r x f).
  const JointPoints& axis = pose.axis_Base;
  const double p_x = p_BasePoint[0], p_y = p_BasePoint[1], p_z = p_BasePoint[2];
  const double f_x = f_Base[0], f_y = f_Base[1], f_z = f_Base[2];
  for (int i = 0; i < joints; i += 2) {
    const Pair r_x = p_x - alignedPairAt(pose.p_BaseJoint.x + i);
    const Pair r_y = p_y - alignedPairAt(pose.p_BaseJoint.y + i);
    const Pair r_z = p_z - alignedPairAt(pose.p_BaseJoint.z + i);
    const Pair x = alignedPairAt(axis.x + i) * (r_y * f_z - r_z * f_y);
    const Pair y = alignedPairAt(axis.y + i) * (r_z * f_x - r_x * f_z);
    const Pair z = alignedPairAt(axis.z + i) * (r_x * f_y - r_y * f_x);
    storePair((x + y) + z, &result[i]);
  }
  for (const int i : chain.prismaticJoints()) {
    if (i > joint) break;
    result[i] = axis[i].dot(f_Base);
  }
  if (joints % 2 == 1) result[joints] = 0.0;  // what the last pair had too many
}

}  // namespace tactus
