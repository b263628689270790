#include "tactus/control/joint_limit_avoidance.h"

#include <algorithm>
#include <cmath>

namespace tactus {

JointLimitAvoidance::JointLimitAvoidance(const JointLimitAvoidanceConfig& config,
                                         const JointLimits& limits) {
  const auto n = limits.lower.size();
  middle_ = inner_half_ = slope_per_s_ = JointVector::Zero(n);
  for (int i = 0; i < n; ++i) {
    if (!std::isfinite(limits.lower[i]) || !std::isfinite(limits.upper[i])) continue;
    const double half = 0.5 * (limits.upper[i] - limits.lower[i]);
    middle_[i] = 0.5 * (limits.upper[i] + limits.lower[i]);
    inner_half_[i] = (1.0 - config.active_fraction) * half;
    slope_per_s_[i] = config.gain * config.gradient_at_limit / (config.active_fraction * half);
  }
}

void JointLimitAvoidance::compute(const JointVector& q, JointVector& gradient) const noexcept {
  gradient.resize(q.size());
  for (int i = 0; i < q.size(); ++i) {
    const double offset = q[i] - middle_[i];
    const double excess = std::max(0.0, std::abs(offset) - inner_half_[i]);
    gradient[i] = std::copysign(slope_per_s_[i] * excess, offset);
  }
}

}  // namespace tactus
