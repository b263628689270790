#include "tactus/control/command_limiter.h"

#include <algorithm>
#include <cmath>

#include "tactus/math/pair.h"

namespace tactus {
namespace {

/// m/s^2 or rad/s^2; stands for "no limit" and keeps every product finite.
constexpr double kUnlimitedAcceleration = 1e12;

/// Velocities that a joint may have in this cycle.
struct Interval {
  double low, high;
  bool contains(double v) const { return v >= low && v <= high; }
};

Interval reachable(double before, double max_velocity, double change) {
  return {std::max(-max_velocity, before - change), std::min(max_velocity, before + change)};
}

/// Largest speed towards a limit `distance` away from which the joint can still brake. Up to
/// `change` = a dt it stops within the next period; above, whole periods of braking and the last
/// part of one cover v dt / 2 + v^2 / (2 a) + a dt^2 / 8 at most.
double brakingSpeed(double distance, double acceleration, double period_s) {
  const double change = acceleration * period_s;
  const double within_one_period = std::max(0.0, distance) / period_s;
  if (within_one_period <= change) return within_one_period;
  return std::max(change, std::sqrt(2.0 * acceleration * distance) - 0.5 * change);
}

double brake(double v, double distance, double acceleration, double period_s) {
  const double ample = std::abs(v) + acceleration * period_s;
  if (ample * ample <= 2.0 * acceleration * distance) return v;  // far away: spares the root
  const double speed = brakingSpeed(distance, acceleration, period_s);
  return std::clamp(v, -speed, speed);
}

/// The factor to which the limits of speed alone shorten the command.
double speedFactor(const JointVector& velocity, const JointVector& max_velocity) {
  double factor = 1.0;
  for (int i = 0; i < velocity.size(); ++i)
    if (std::abs(velocity[i]) > max_velocity[i])
      factor = std::min(factor, max_velocity[i] / std::abs(velocity[i]));
  return factor;
}

/// The largest factor of at most 1 that brings every v into its interval. If there is none, that
/// of the speeds alone: each joint goes there by itself, and has its part of the direction when its
/// own acceleration allows. By the command as it is they would keep another for as long as it asks
/// for too much.
double commonFactor(const JointVector& velocity, const Interval* intervals,
                    const JointVector& max_velocity) {
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < velocity.size(); ++i) {
    const double v = velocity[i];
    if (v == 0.0) {
      if (!intervals[i].contains(0.0)) return speedFactor(velocity, max_velocity);
      continue;
    }
    const double a = intervals[i].low / v;
    const double b = intervals[i].high / v;
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  return low <= high ? high : speedFactor(velocity, max_velocity);
}

}  // namespace

CommandLimiter::CommandLimiter(const JointLimits& limits) : limits_(limits) {
  limits_.max_acceleration = limits.max_acceleration.cwiseMin(kUnlimitedAcceleration);
}

/// Two joints at a time; an odd number's last two overlap with the two before. Every comparison
/// with NaN is false, and infinity is beyond each change of velocity.
bool CommandLimiter::admits(const JointVector& q, const JointVector& velocity_before,
                            double period_s, const JointVector& velocity) const noexcept {
  const int last = static_cast<int>(velocity.size()) - 2;
  if (last < 0) return false;
  Pair refused = {};
  for (int i = 0; i <= last + 1; i += 2) {
    const int k = std::min(i, last);
    const Pair v = pairAt(velocity.data() + k);
    const Pair before = pairAt(velocity_before.data() + k);
    const Pair acceleration = pairAt(limits_.max_acceleration.data() + k);
    const Pair change = acceleration * period_s;
    const Pair speed = magnitude(v);
    const PairMask reachable = (speed <= pairAt(limits_.max_velocity.data() + k)) &
                               (v >= before - change) & (v <= before + change);
    // Far from both limits, by the measure of brake().
    const Pair place = pairAt(q.data() + k);
    const Pair distance =
        smaller(pairAt(limits_.upper.data() + k) - place, place - pairAt(limits_.lower.data() + k));
    const Pair ample = speed + change;
    const PairMask far = ample * ample <= (acceleration + acceleration) * distance;
    refused += (reachable & far) ? Pair{0.0, 0.0} : Pair{1.0, 1.0};
  }
  return refused[0] + refused[1] == 0.0;
}

bool CommandLimiter::apply(const JointVector& q, const JointVector& velocity_before,
                           double period_s, JointVector& velocity) const noexcept {
  Interval intervals[kMaxJoints];
  bool admissible = true;
  double sum = 0.0;  // not finite as soon as one velocity is not
  for (int i = 0; i < velocity.size(); ++i) {
    double& v = velocity[i];
    sum += std::abs(v);
    const double acceleration = limits_.max_acceleration[i];
    const double distance = v > 0.0 ? limits_.upper[i] - q[i] : q[i] - limits_.lower[i];
    v = brake(v, distance, acceleration, period_s);
    intervals[i] = reachable(velocity_before[i], limits_.max_velocity[i], acceleration * period_s);
    admissible = admissible && intervals[i].contains(v);
  }
  const bool finite = std::isfinite(sum);
  if (!finite) velocity.setZero();
  if (admissible && finite) return true;
  const double factor = commonFactor(velocity, intervals, limits_.max_velocity);
  for (int i = 0; i < velocity.size(); ++i)
    velocity[i] = std::clamp(factor * velocity[i], intervals[i].low, intervals[i].high);
  return finite;
}

}  // namespace tactus
