#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

struct JointLimitCost {
  ScaledVector gradient;  ///< alpha W^-1/2 dH/dq, m/s or rad/s
  double nearness = 0.0;  ///< s_max, 0 to 1: the joint nearest to a limit
};

/// What follows from these gains alone. Zero beyond the robot's joints, and for joints without
/// limits.
struct JointLimitZones {
  JointLimitAvoidanceGains gains{0.0, 0.0, 0.0};   ///< f = 0: of none yet
  ScaledVector inner_half = ScaledVector::Zero();  ///< half width of the zone without cost
  ScaledVector inv_width = ScaledVector::Zero();   ///< 1 / (f half)
  ScaledVector slope = ScaledVector::Zero();       ///< alpha W^-1/2 gradient_at_limit / (f half)
};

/// dH/dq of (1), pointing towards the nearer limit (N alpha dH/dq is subtracted):
///   s_i = max(0, (|q_i - mid_i| - (1 - f) half_i) / (f half_i))
///   dH/dq_i = gradient_at_limit s_i sign(q_i - mid_i)
/// Joints without limits get zero. With weights the arm follows W^-1 dH/dq, steepest in the metric
/// of W like every other controller's b = W^-1 J_p^T F^: where it comes to rest does not depend on
/// W.
class JointLimitAvoidance {
 public:
  JointLimitAvoidance(const JointLimits& limits, const ScaledVector& inv_sqrt_weights);

  JointLimitZones zones(const JointLimitAvoidanceGains& gains) const noexcept;

  JointLimitCost evaluate(const JointLimitZones& zones, const JointVector& q) const noexcept;

  /// With the zones of these gains: those kept are of these or others, and follow.
  JointLimitCost evaluate(const JointLimitAvoidanceGains& gains, const JointVector& q,
                          JointLimitZones& zones_kept) const noexcept;

 private:
  // Zero beyond the robot's joints, and for joints without limits.
  ScaledVector middle_ = ScaledVector::Zero();  ///< of the range
  ScaledVector half_ = ScaledVector::Zero();    ///< half width of the range
  ScaledVector inv_sqrt_weights_;
};

}  // namespace tactus
