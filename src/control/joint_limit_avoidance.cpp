#include "tactus/control/joint_limit_avoidance.h"

#include <algorithm>
#include <cmath>

namespace tactus {

JointLimitAvoidance::JointLimitAvoidance(const JointLimitAvoidanceConfig& config,
                                         const JointLimits& limits)
    : gradient_at_limit_(config.gain * config.gradient_at_limit) {
  const auto n = limits.lower.size();
  middle_ = inner_half_ = slope_per_s_ = JointVector::Zero(n);
  for (int i = 0; i < n; ++i) {
    const double half = 0.5 * (limits.upper[i] - limits.lower[i]);
    if (!std::isfinite(half) || half == 0.0) continue;  // no limits, or a locked joint
    middle_[i] = 0.5 * (limits.upper[i] + limits.lower[i]);
    inner_half_[i] = (1.0 - config.active_fraction) * half;
    slope_per_s_[i] = gradient_at_limit_ / (config.active_fraction * half);
  }
}

double JointLimitAvoidance::compute(const JointVector& q, JointVector& gradient) const noexcept {
  gradient.resize(q.size());
  double steepest = 0.0;
  for (int i = 0; i < q.size(); ++i) {
    const double offset = q[i] - middle_[i];
    const double slope = slope_per_s_[i] * std::max(0.0, std::abs(offset) - inner_half_[i]);
    gradient[i] = std::copysign(slope, offset);
    steepest = std::max(steepest, slope);
  }
  return gradient_at_limit_ > 0.0 ? std::min(1.0, steepest / gradient_at_limit_) : 0.0;
}

}  // namespace tactus
