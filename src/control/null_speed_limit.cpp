#include "tactus/control/null_speed_limit.h"

#include <algorithm>
#include <cmath>

namespace tactus {

NullSpeedLimit::NullSpeedLimit(const SerialChain& chain, const ScaledVector& inv_sqrt_weights)
    : inv_sqrt_weights_(inv_sqrt_weights) {
  for (int i = 0; i < chain.size(); ++i) is_prismatic_[i] = chain.type(i) == JointType::kPrismatic;
}

void NullSpeedLimit::renew(const ForceGains& gains, NullSpeedLimits& limits) const noexcept {
  if (limits.max_speed_m_per_s == gains.max_null_speed_m_per_s &&
      limits.max_speed_rad_per_s == gains.max_null_speed_rad_per_s)
    return;
  limits.max_speed_m_per_s = gains.max_null_speed_m_per_s;
  limits.max_speed_rad_per_s = gains.max_null_speed_rad_per_s;
  for (int i = 0; i < kMaxJoints; ++i) {
    limits.inverse[i] = inv_sqrt_weights_[i] /
                        (is_prismatic_[i] ? limits.max_speed_m_per_s : limits.max_speed_rad_per_s);
  }
}

double NullSpeedLimit::share(const ForceGains& gains, const ScaledVector& v_scaled,
                             NullSpeedLimits& limits) const noexcept {
  renew(gains, limits);
  const double excess = v_scaled.cwiseAbs().cwiseProduct(limits.inverse).maxCoeff();
  return excess > 1.0 ? 1.0 / excess : 1.0;
}

double NullSpeedLimit::shareOnTop(const ForceGains& gains, const ScaledVector& v_scaled,
                                  const ScaledVector& push_scaled,
                                  NullSpeedLimits& limits) const noexcept {
  renew(gains, limits);
  double share = 1.0;
  for (int i = 0; i < kMaxJoints; ++i) {
    const double push = std::abs(push_scaled[i]) * limits.inverse[i];
    const double v = std::copysign(1.0, push_scaled[i]) * v_scaled[i] * limits.inverse[i];
    const double left = std::max(1.0, std::abs(v)) - v;
    if (push * share > left) share = left / push;
  }
  return share;
}

}  // namespace tactus
