#pragma once

#include "tactus/math/serial_chain.h"

namespace tactus {

/// J_dot q_dot: how a point accelerates, and its link turns faster, while no joint accelerates.
struct VelocityProduct {
  Vector3 linear;   ///< of the point, m/s^2, base frame
  Vector3 angular;  ///< of its link, rad/s^2, base frame
  Vector3 omega;    ///< how fast its link turns, rad/s, base frame
};

/// Of the point at p_BasePoint (base frame, m), which moves with `joint`; -1: with the base, which
/// rests. By the velocity and acceleration recursion of Newton-Euler, with q_ddot = 0.
VelocityProduct velocityProduct(const SerialChain& chain, const ChainPose& pose, int joint,
                                const Vector3& p_BasePoint, const JointVector& q_dot) noexcept;

}  // namespace tactus
