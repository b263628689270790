#pragma once

#include <vector>

#include "tactus/math/serial_chain.h"

namespace tactus {

/// All that moves with one joint, as one rigid body in the joint's frame.
struct BodyInertia {
  double mass_kg = 0.0;
  Vector3 p_JointCom = Vector3::Zero();  ///< centre of mass, m
  Matrix3 I_Com = Matrix3::Zero();       ///< about the centre of mass, kg m^2
};

/// Both as one body.
BodyInertia combined(const BodyInertia& a, const BodyInertia& b) noexcept;
/// A body that is given in frame B, in frame A.
BodyInertia transformed(const Pose& X_AB, const BodyInertia& body) noexcept;

using MassMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;

/// M(q) of the kinetic energy q_dot^T M q_dot / 2, by composite rigid bodies (Walker and Orin,
/// 1982); bodies: one a joint; kg m^2 for rotations, kg for translations.
void computeMassMatrix(const SerialChain& chain, const ChainPose& pose,
                       const std::vector<BodyInertia>& bodies, MassMatrix& M) noexcept;

/// With the joints at q, m or rad.
MassMatrix massMatrixAt(const SerialChain& chain, const std::vector<BodyInertia>& bodies,
                        const JointVector& q) noexcept;

}  // namespace tactus
