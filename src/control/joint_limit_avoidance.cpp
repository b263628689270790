#include "tactus/control/joint_limit_avoidance.h"

#include <algorithm>
#include <cmath>

namespace tactus {

JointLimitAvoidance::JointLimitAvoidance(const JointLimits& limits,
                                         const ScaledVector& inv_sqrt_weights)
    : inv_sqrt_weights_(inv_sqrt_weights) {
  for (int i = 0; i < limits.lower.size(); ++i) {
    const double half = 0.5 * (limits.upper[i] - limits.lower[i]);
    if (!std::isfinite(half) || half == 0.0) continue;  // no limits, or a locked joint
    middle_[i] = 0.5 * (limits.upper[i] + limits.lower[i]);
    half_[i] = half;
  }
}

JointLimitZones JointLimitAvoidance::zones(const JointLimitAvoidanceGains& gains) const noexcept {
  JointLimitZones zones{.gains = gains};
  for (int i = 0; i < kMaxJoints; ++i) {
    if (half_[i] == 0.0) continue;
    zones.inner_half[i] = (1.0 - gains.active_fraction) * half_[i];
    zones.inv_width[i] = 1.0 / (gains.active_fraction * half_[i]);
    zones.slope[i] =
        gains.gain * gains.gradient_at_limit * zones.inv_width[i] * inv_sqrt_weights_[i];
  }
  return zones;
}

JointLimitCost JointLimitAvoidance::evaluate(const JointLimitZones& zones,
                                             const JointVector& q) const noexcept {
  ScaledVector offset = ScaledVector::Zero();
  for (int i = 0; i < q.size(); ++i) offset[i] = q[i] - middle_[i];
  const ScaledVector excess =
      offset - offset.cwiseMin(zones.inner_half).cwiseMax(-zones.inner_half);
  const double s_max = excess.cwiseAbs().cwiseProduct(zones.inv_width).maxCoeff();
  return {zones.slope.cwiseProduct(excess), std::min(1.0, s_max)};
}

JointLimitCost JointLimitAvoidance::evaluate(const JointLimitAvoidanceGains& gains,
                                             const JointVector& q,
                                             JointLimitZones& zones_kept) const noexcept {
  if (!isSame(zones_kept.gains, gains)) zones_kept = zones(gains);
  return evaluate(zones_kept, q);
}

}  // namespace tactus
