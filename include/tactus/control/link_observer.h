#pragma once

#include <vector>

#include "tactus/math/mass_matrix.h"

namespace tactus {

/// Links behind flexible gears whose motors alone are measured. Per joint in Nm/rad and Nm s/rad,
/// or N/m and N s/m of a prismatic one.
struct GearedLinks {
  std::vector<BodyInertia> bodies;  ///< one a joint
  JointVector gear_stiffness;       ///< finite, > 0
  JointVector gear_damping;         ///< >= 0
};

struct LinkObserverState {
  JointVector q, velocity;  ///< of the links; empty: not started
  JointVector q_motor;      ///< at the joint
};

/// Where the links are, one step_s on:
///   M(q) q_ddot = K (q_motor - q) + D (q_motor_dot - q_dot)
/// by implicit Euler, which stands any gear. Gravity only shifts it, which the drives have made up
/// for; contacts bend gears by less than counts. They start at rest at their motors.
void observeLinks(const SerialChain& chain, const GearedLinks& links, const JointVector& q_motor,
                  double step_s, LinkObserverState& state) noexcept;

}  // namespace tactus
