#include "tactus/canopen/joint_tracking.h"

#include <algorithm>
#include <cmath>

namespace tactus {

double trackingVelocity(const DriveConfig& config, double velocity, double position,
                        double measured) noexcept {
  const double limit = config.max_following_error;
  const double lag = std::clamp(position - measured, -limit, limit);
  const double tracking = velocity + config.tracking_gain_per_s * lag;
  return std::clamp(tracking, -config.max_velocity, config.max_velocity);
}

double distanceFrom(const CommandedPlace& place, double position) noexcept {
  const auto [lowest, highest] = std::minmax(place.now, place.before_pause);
  return std::max({0.0, lowest - position, position - highest});
}

void judgePosition(const DriveConfig& config, const CommandedPlace& place, bool is_new,
                   DriveReport& report) noexcept {
  const bool is_finite = std::isfinite(place.now) && std::isfinite(place.before_pause);
  if (!is_finite) return latch(Fault::kCommandNotFinite, {}, report);
  const double distance = distanceFrom(place, report.position);
  const double limit = config.max_following_error;
  if (is_new && distance > limit)
    latch(Fault::kFollowingError, {distance, limit, "m or rad"}, report);
}

}  // namespace tactus
