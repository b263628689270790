#pragma once

#include <array>
#include <limits>

#include "tactus/control/gains.h"
#include "tactus/math/serial_chain.h"

namespace tactus {

/// 1 / (W^1/2 limit) of each joint; zero beyond the robot's joints.
struct NullSpeedLimits {
  /// That this follows from; NaN: from none yet.
  double max_speed_m_per_s = std::numeric_limits<double>::quiet_NaN();
  double max_speed_rad_per_s = std::numeric_limits<double>::quiet_NaN();
  ScaledVector inverse = ScaledVector::Zero();
};

/// The speeds that the null space may give joints.
class NullSpeedLimit {
 public:
  NullSpeedLimit(const SerialChain& chain, const ScaledVector& inv_sqrt_weights);

  /// The factor of at most 1 that keeps every component of a scaled velocity within them.
  double share(const ForceGains& gains, const ScaledVector& v_scaled,
               NullSpeedLimits& limits) const noexcept;

  /// Likewise, of a push on top of another velocity, for their sum. A component that is beyond its
  /// limit without the push may be as large as it was.
  double shareOnTop(const ForceGains& gains, const ScaledVector& v_scaled,
                    const ScaledVector& push_scaled, NullSpeedLimits& limits) const noexcept;

 private:
  /// Where they follow from other gains.
  void renew(const ForceGains& gains, NullSpeedLimits& limits) const noexcept;

  ScaledVector inv_sqrt_weights_;
  std::array<bool, kMaxJoints> is_prismatic_{};
};

}  // namespace tactus
