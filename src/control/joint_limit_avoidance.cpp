#include "tactus/control/joint_limit_avoidance.h"

#include <algorithm>
#include <cmath>

namespace tactus {

JointLimitAvoidance::JointLimitAvoidance(const JointLimitAvoidanceConfig& config,
                                         const JointLimits& limits,
                                         const ScaledVector& inv_sqrt_weights) {
  for (int i = 0; i < limits.lower.size(); ++i) {
    const double half = 0.5 * (limits.upper[i] - limits.lower[i]);
    if (!std::isfinite(half) || half == 0.0) continue;  // no limits, or a locked joint
    middle_[i] = 0.5 * (limits.upper[i] + limits.lower[i]);
    inner_half_[i] = (1.0 - config.active_fraction) * half;
    inv_width_[i] = 1.0 / (config.active_fraction * half);
    slope_[i] = config.gain * config.gradient_at_limit * inv_width_[i] * inv_sqrt_weights[i];
  }
}

JointLimitCost JointLimitAvoidance::evaluate(const JointVector& q) const noexcept {
  ScaledVector offset = ScaledVector::Zero();
  for (int i = 0; i < q.size(); ++i) offset[i] = q[i] - middle_[i];
  const ScaledVector excess = offset - offset.cwiseMin(inner_half_).cwiseMax(-inner_half_);
  const double s_max = excess.cwiseAbs().cwiseProduct(inv_width_).maxCoeff();
  return {slope_.cwiseProduct(excess), std::min(1.0, s_max)};
}

}  // namespace tactus
