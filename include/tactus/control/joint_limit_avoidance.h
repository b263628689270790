#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

/// dH/dq of (1), pointing towards the nearer limit (N alpha dH/dq is subtracted):
///   s_i = max(0, (|q_i - mid_i| - (1 - f) half_i) / (f half_i))
///   dH/dq_i = gradient_at_limit s_i sign(q_i - mid_i)
/// Joints without limits get zero. With weights the arm follows W^-1 dH/dq, steepest in the metric
/// of W like every other controller's b = W^-1 J_p^T F^: where it comes to rest does not depend on
/// W.
class JointLimitAvoidance {
 public:
  JointLimitAvoidance(const JointLimitAvoidanceConfig& config, const JointLimits& limits);

  /// alpha dH/dq, m/s or rad/s. Returns s_max, 0 to 1: how far the joint nearest to a limit has
  /// come through its outer zone.
  double compute(const JointVector& q, JointVector& gradient) const noexcept;

 private:
  JointVector middle_;        ///< of the range
  JointVector inner_half_;    ///< half width of the zone without cost
  double gradient_at_limit_;  ///< alpha gradient_at_limit
  JointVector slope_per_s_;   ///< alpha gradient_at_limit / width of the outer zone
};

}  // namespace tactus
