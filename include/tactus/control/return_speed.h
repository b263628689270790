#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

/// An arm that its drives had let go may stand beside its path where it goes on, or nearer to a
/// joint limit, and beta e or the way out of the limit's zone at once would be a jump. So beta and
/// joint space's pull grow linearly within this time: with beta = 5/s an error e makes at most
/// 1.0 e /s, and not 5. The way out is not scaled, for it may hold a contact's push off, but
/// capped.
inline constexpr double kReturnRise_s = 2.0;

/// Of each joint's way out of a limit's zone where an arm goes on, m/s or rad/s.
inline constexpr double kFirstWayOut = 0.2;

/// Caps the joint velocities W^-1/2 v_scaled to kFirstWayOut / (1 - share), with the share of
/// kReturnRise_s that is over, below 1.
void capWayOut(double share, const ScaledVector& inv_sqrt_weights, ScaledVector& v_scaled) noexcept;

inline bool hasReturnSpeed(const TaskGains& gains) noexcept {
  return gains.max_return_speed_m_per_s < kNoLimit || gains.max_return_speed_rad_per_s < kNoLimit;
}

/// Scales a correction of the task's components, m/s and rad/s, down to the return speeds, see
/// TaskConfig; push: p there, or empty.
void limitReturnSpeed(const TaskGains& gains, const TaskConfig& task, const TaskVector& push,
                      TaskVector& correction) noexcept;

}  // namespace tactus
