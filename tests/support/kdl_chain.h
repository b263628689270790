#pragma once

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <vector>

#include "tactus/math/serial_chain.h"

/// The same chain for Orocos KDL, the independent oracle of kinematics.
namespace tactus::test {

inline KDL::Vector toKdl(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

inline KDL::Frame toKdl(const Pose& X) {
  const Matrix3& R = X.R_AB;
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                        R(2, 2)),
          toKdl(X.p_AB)};
}

/// The joints up to the one that carries `frame`, with the frame at the end.
inline KDL::Chain toKdl(const std::vector<Joint>& joints, const AttachedFrame& frame) {
  KDL::Chain chain;
  for (int i = 0; i <= frame.joint; ++i) {
    const auto type =
        joints[i].type == JointType::kPrismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), toKdl(joints[i].X_ParentJoint)));
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Vector::Zero(), toKdl(joints[i].axis), type)));
  }
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), toKdl(frame.X_JointFrame)));
  return chain;
}

inline KDL::JntArray toKdl(const JointVector& q, int count) {
  KDL::JntArray joints(count);
  for (int i = 0; i < count; ++i) joints(i) = q[i];
  return joints;
}

/// 6 x (number of joints before the frame): linear rows first, of the frame's origin, base frame.
inline Eigen::MatrixXd kdlJacobian(const std::vector<Joint>& joints, const AttachedFrame& frame,
                                   const JointVector& q) {
  const KDL::Chain chain = toKdl(joints, frame);
  KDL::ChainJntToJacSolver solver(chain);
  KDL::Jacobian jacobian(chain.getNrOfJoints());
  solver.JntToJac(toKdl(q, frame.joint + 1), jacobian);
  return jacobian.data;
}

inline Pose kdlPose(const std::vector<Joint>& joints, const AttachedFrame& frame,
                    const JointVector& q) {
  const KDL::Chain chain = toKdl(joints, frame);
  KDL::ChainFkSolverPos_recursive solver(chain);
  KDL::Frame result;
  solver.JntToCart(toKdl(q, frame.joint + 1), result);
  Pose pose;
  for (int i = 0; i < 3; ++i) {
    pose.p_AB[i] = result.p[i];
    for (int j = 0; j < 3; ++j) pose.R_AB(i, j) = result.M(i, j);
  }
  return pose;
}

}  // namespace tactus::test
