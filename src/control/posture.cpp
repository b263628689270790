#include "tactus/control/posture.h"

#include <algorithm>

namespace tactus {

Posture::Posture(const JointVector& q_posture, const JointVector& max_velocity,
                 const ScaledVector& inv_sqrt_weights)
    : q_posture_(q_posture),
      inv_max_velocity_(max_velocity.cwiseInverse()),
      sqrt_weights_(inv_sqrt_weights.cwiseInverse()) {}

void Posture::addTo(ScaledVector& gradient, const PostureGains& gains,
                    const JointVector& q) const noexcept {
  const JointVector velocity = gains.gain_per_s * (q - q_posture_);
  const double to_max = velocity.cwiseProduct(inv_max_velocity_).cwiseAbs().maxCoeff();
  const double share = 1.0 / std::max(1.0, to_max / gains.max_speed_share);
  for (int i = 0; i < q.size(); ++i) gradient[i] += share * velocity[i] * sqrt_weights_[i];
}

}  // namespace tactus
