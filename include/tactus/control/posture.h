#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

// clang-format off: equations
/// Leads the joints to a posture q_p through the null space. Not the paper's, but a cost beside its
/// joint limits in (1):
///   H = k/2 (q - q_p)^T W (q - q_p),   q_dot = -s W^-1 dH/dq = -s k (q - q_p)
///   s = min(1, min_i share v_max,i / |k (q_i - q_p,i)|)
/// Steepest in the metric of W, like every null-space motion, and bounded as a whole, so that
/// joints that have the whole null space go straight there. Turns are counted: a joint that has
/// been turned round once is turned back.
// clang-format on
class Posture {
 public:
  Posture(const JointVector& q_posture, const JointVector& max_velocity,
          const ScaledVector& inv_sqrt_weights);

  /// Adds s W^-1/2 dH/dq, which is subtracted later, m/s or rad/s, for the robot's joints.
  void addTo(ScaledVector& gradient, const PostureGains& gains,
             const JointVector& q) const noexcept;

 private:
  JointVector q_posture_;
  JointVector inv_max_velocity_;  ///< zero where there is no limit
  ScaledVector sqrt_weights_;
};

}  // namespace tactus
