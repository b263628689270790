#include "tactus/control/command_limiter.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

/// Largest speed towards a limit `distance` away from which the joint can still brake.
double brakingSpeed(double distance, double acceleration, double period_s) {
  const double within_one_period = std::max(0.0, distance) / period_s;
  if (!(acceleration < kNoLimit) || !(distance < kNoLimit)) return within_one_period;
  const double braking =
      std::sqrt(2.0 * acceleration * std::max(0.0, distance)) - 0.5 * acceleration * period_s;
  return std::min(within_one_period, std::max(0.0, braking));
}

struct Interval {
  double low, high;
};

/// Velocities a joint may have now, given its previous one.
Interval reachable(double before, double max_velocity, double max_acceleration, double period_s) {
  const double change = max_acceleration * period_s;
  return {std::max(-max_velocity, before - change), std::min(max_velocity, before + change)};
}

}  // namespace

bool CommandLimiter::apply(const JointVector& q, const JointVector& velocity_before,
                           double period_s, JointVector& velocity) const noexcept {
  const bool finite = std::isfinite(velocity.lpNorm<1>());
  if (!finite) velocity.setZero();
  brakeBeforePositionLimits(q, period_s, velocity);
  shorten(velocity_before, period_s, velocity);
  return finite;
}

void CommandLimiter::brakeBeforePositionLimits(const JointVector& q, double period_s,
                                               JointVector& velocity) const noexcept {
  for (int i = 0; i < q.size(); ++i) {
    const bool up = velocity[i] > 0.0;
    const double distance = up ? limits_.upper[i] - q[i] : q[i] - limits_.lower[i];
    const double speed = brakingSpeed(distance, limits_.max_acceleration[i], period_s);
    velocity[i] = up ? std::min(velocity[i], speed) : std::max(velocity[i], -speed);
  }
}

void CommandLimiter::shorten(const JointVector& velocity_before, double period_s,
                             JointVector& velocity) const noexcept {
  double factor_low = 0.0;
  double factor_high = 1.0;
  for (int i = 0; i < velocity.size(); ++i) {
    const auto [low, high] = reachable(velocity_before[i], limits_.max_velocity[i],
                                       limits_.max_acceleration[i], period_s);
    const double v = velocity[i];
    if (v >= low && v <= high && low <= 0.0 && high >= 0.0) continue;
    if (v == 0.0) {
      factor_high = -1.0;  // rest is out of reach: no multiple of the command will do
      continue;
    }
    factor_low = std::max(factor_low, std::min(low / v, high / v));
    factor_high = std::min(factor_high, std::max(low / v, high / v));
  }
  const double factor = factor_low <= factor_high ? factor_high : 1.0;
  for (int i = 0; i < velocity.size(); ++i) {
    const auto [low, high] = reachable(velocity_before[i], limits_.max_velocity[i],
                                       limits_.max_acceleration[i], period_s);
    velocity[i] = std::clamp(factor * velocity[i], low, high);
  }
}

}  // namespace tactus
