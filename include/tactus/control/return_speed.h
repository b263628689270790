#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

/// An arm that its drives had let go may stand beside its path where it goes on, or where it
/// starts, nearer to a joint limit or away from its posture, and beta e or the way out of the
/// limit's zone and to the posture at once would be a jump. So beta and joint space's pull grow
/// linearly within this time: with beta = 5/s an error e makes at most 1.0 e /s, and not 5. Of the
/// way out what the stop added grows likewise, and all of the way to a posture and of `avoid`.
/// Where the arm leans on something, what there was before of the way out has held its push off,
/// and comes as fast as the law's answer does anew; and so does that of an arm that starts in a
/// zone, or goes on there after a hold: it may be what holds the path's motion off.
inline constexpr double kReturnRise_s = 2.0;
inline constexpr double kAnswerRise_s = 0.3;

/// Takes from a way out what is not to be there yet of the one before the stop and of what the stop
/// added, with the share of kReturnRise_s that is over. It is never more than the law's, nor
/// against it, and whatever the arm meets deeper in the zone counts at once.
void softenWayOut(double share, const ScaledVector& before, const ScaledVector& added,
                  ScaledVector& way_out) noexcept;

inline bool hasReturnSpeed(const TaskGains& gains) noexcept {
  return gains.max_return_speed_m_per_s < kNoLimit || gains.max_return_speed_rad_per_s < kNoLimit;
}

/// Scales a correction of the task's components, m/s and rad/s, down to the return speeds, see
/// TaskConfig; push: p there, or empty.
void limitReturnSpeed(const TaskGains& gains, const TaskConfig& task, const TaskVector& push,
                      TaskVector& correction) noexcept;

}  // namespace tactus
