#include "tactus/canopen/joint_tracking.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

/// A command is seen in the feedback of the next cycle, and one may be late.
constexpr int kLateCycles = 3;

}  // namespace

double trackingVelocity(const DriveConfig& config, double velocity, double position,
                        double measured) noexcept {
  const double limit = config.max_following_error;
  const double lag = std::clamp(position - measured, -limit, limit);
  const double tracking = velocity + config.tracking_gain_per_s * lag;
  return std::clamp(tracking, -config.max_velocity, config.max_velocity);
}

void CommandedPlaces::coast() noexcept {
  q_before_pause_ = q_now_;
  late_cycles_ = kLateCycles;
}

void CommandedPlaces::command(const JointVector& q) noexcept {
  q_now_ = q;
  late_cycles_ = std::max(0, late_cycles_ - 1);
}

CommandedPlace CommandedPlaces::at(int joint) const noexcept {
  const double now = q_now_[joint];
  return {now, late_cycles_ > 0 ? q_before_pause_[joint] : now};
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
