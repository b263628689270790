#include "tactus/math/axis_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus {
namespace {

constexpr int kMaxSteps = 100;  ///< of the search; some ten are enough

AxisState advance(const AxisState& from, double jerk, double t) {
  return {from.p + t * (from.v + t * (from.a / 2.0 + t * jerk / 6.0)),
          from.v + t * (from.a + t * jerk / 2.0), from.a + t * jerk};
}

/// Acceleration is led to a peak, kept there, and led to zero.
struct SpeedChange {
  std::array<double, 3> duration, jerk;
};

SpeedChange speedChange(const AxisState& from, double v, const MotionLimits& limits) {
  const double J = limits.max_jerk, A = limits.max_acceleration;
  const double v_without = from.v + from.a * std::abs(from.a) / (2.0 * J);  // if a goes to zero
  const double sign = v >= v_without ? 1.0 : -1.0;
  const double a = sign * from.a, dv = sign * (v - from.v);
  double peak = std::sqrt(std::max(0.0, J * dv + a * a / 2.0));
  double kept_s = 0.0;
  if (peak > A || a > A) {
    peak = A;
    const double to_peak = (a > A ? a * a - A * A : A * A - a * a) / (2.0 * J);  // adds so much
    kept_s = std::max(0.0, dv - to_peak - A * A / (2.0 * J)) / A;
  }
  return {{std::abs(peak - a) / J, kept_s, peak / J}, {sign * (a > peak ? -J : J), 0.0, -sign * J}};
}

/// The state after the first `at_most` seconds of a change, or all of it.
AxisState advance(AxisState state, const SpeedChange& change, double at_most) {
  for (int i = 0; i < 3; ++i) {
    const double t = std::min(change.duration[i], at_most);
    state = advance(state, change.jerk[i], t);
    at_most -= t;
  }
  return state;
}

constexpr double kAll = std::numeric_limits<double>::infinity();

/// Where a stop ends.
double stopPlace(const AxisState& from, const MotionLimits& limits) {
  return advance(from, speedChange(from, 0.0, limits), kAll).p;
}

/// The moment of `change` at which a stop has to begin to end `sign` (+-1) before the target.
double brakingMoment(const AxisState& from, const SpeedChange& change, double target, double sign,
                     const MotionLimits& limits) {
  const auto excess = [&](double t) {
    return sign * (stopPlace(advance(from, change, t), limits) - target);
  };
  double low = 0.0, high = change.duration[0] + change.duration[1] + change.duration[2];
  double below = excess(low), above = excess(high);
  const double close = 2e-16 * std::max(std::abs(from.p), std::abs(target));
  if (std::abs(below) <= close) return low;
  double t = low;
  for (int step = 0; step < kMaxSteps; ++step) {
    // Where excess is flat, a secant does not get on.
    t = step % 3 == 2 ? 0.5 * (low + high) : low - below * (high - low) / (above - below);
    if (!(t > low && t < high)) t = 0.5 * (low + high);
    if (t <= low || t >= high) break;
    const double at = excess(t);
    if (std::abs(at) <= close) break;
    (at < 0.0 ? low : high) = t;
    (at < 0.0 ? below : above) = at;
  }
  return t;
}

}  // namespace

AxisMotion::AxisMotion(const AxisState& from, double target, const MotionLimits& limits) noexcept
    : target_(target), end_(from) {
  const double sign = target >= stopPlace(from, limits) ? 1.0 : -1.0;
  const double v = sign * limits.max_speed;
  const SpeedChange change = speedChange(from, v, limits);
  const double left = sign * (target - stopPlace(advance(from, change, kAll), limits));
  double at_most = left >= 0.0 ? kAll : brakingMoment(from, change, target, sign, limits);
  for (int i = 0; i < 3; ++i) {
    append(std::min(change.duration[i], at_most), change.jerk[i]);
    at_most -= change.duration[i];
  }
  if (left > 0.0) {
    end_.a = 0.0;  // of what rounding leaves much would come in hours
    append(left / std::abs(end_.v), 0.0);
  }
  appendStop(limits);
}

AxisMotion AxisMotion::stop(const AxisState& from, const MotionLimits& limits) noexcept {
  AxisMotion motion;
  motion.end_ = from;
  motion.appendStop(limits);
  motion.target_ = motion.end_.p;
  return motion;
}

void AxisMotion::append(double duration, double jerk) noexcept {
  if (!(duration > 0.0)) return;
  phases_[size_++] = {duration_, end_, jerk};
  duration_ += duration;
  end_ = advance(end_, jerk, duration);
}

void AxisMotion::appendStop(const MotionLimits& limits) noexcept {
  const SpeedChange change = speedChange(end_, 0.0, limits);
  for (int i = 0; i < 3; ++i) append(change.duration[i], change.jerk[i]);
}

AxisState AxisMotion::at(double t) const noexcept {
  if (t >= duration_) return {target_, 0.0, 0.0};
  int i = size_ - 1;
  while (i > 0 && t < phases_[i].start) --i;
  return advance(phases_[i].from, phases_[i].jerk, t - phases_[i].start);
}

double AxisMotion::jerk(double t) const noexcept {
  if (t >= duration_) return 0.0;
  int i = size_ - 1;
  while (i > 0 && t < phases_[i].start) --i;
  return phases_[i].jerk;
}

}  // namespace tactus
