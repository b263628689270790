#pragma once

#include "tactus/control/body_distances.h"
#include "tactus/math/serial_chain.h"
#include "tactus/math/weighted_pseudoinverse.h"

namespace tactus {

/// What depends on the desired configuration and the reference alone, and not on the contact.
struct TaskKinematics {
  ChainPose pose;
  WeightedPseudoinverse pseudoinverse;
  PaddedTaskVector error;  ///< w_d - w, m or rad; of rotations the vector of R_d R^T
  PaddedTaskVector y_eff;  ///< solve(w_dot_d,eff), (2)
  NearBodies near;         ///< only with a clearance
};

struct FreeAcceleration;

/// Where earlier commands have led to.
struct CommandedMotion {
  const JointVector& q;         ///< desired, at the start of this cycle
  const JointVector& velocity;  ///< the previous command
  bool is_followed;             ///< this cycle's command moves the arm; false: it stops, or rests
  double return_share = 1.0;    ///< of the pull, see return_speed.h
  const FreeAcceleration* free = nullptr;  ///< acceleration level only

  bool isAtRest() const noexcept { return !is_followed && velocity.isZero(0.0); }
};

/// The motion equation (1) as it comes together: q_dot = W^-1/2 (Q y + v_scaled), with everything
/// that goes through N or J# gathered in y.
struct Motion {
  PaddedTaskVector y;
  ScaledVector v_scaled;
  ScaledVector a;               ///< J_p^T F^ of the contact, m or m/rad; set by the law of one
  double limit_nearness = 0.0;  ///< s_max of the joint-limit cost, 0 to 1
};

}  // namespace tactus
