#include "tactus/commission/stroke_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus {
namespace {

constexpr double kPeriods = 4.0;

/// A quintic from 0 to 1 with s' = s'' = 0 at both ends, and its two derivatives.
AxisState smoothStep(double x) noexcept {
  if (x <= 0.0) return {0.0, 0.0, 0.0};
  if (x >= 1.0) return {1.0, 0.0, 0.0};
  return {x * x * x * (10.0 + x * (-15.0 + 6.0 * x)), 30.0 * x * x * (1.0 - x) * (1.0 - x),
          60.0 * x * (1.0 + x * (-3.0 + 2.0 * x))};
}

/// Largest derivatives of the step: 1.875 at x = 1/2, and 10 / sqrt(3).
constexpr double kSteepest = 1.875;
constexpr double kMostCurved = 5.7735;

}  // namespace

StrokeMotion::StrokeMotion(const StrokeShape& shape, const MotionLimits& limits) noexcept
    : shape_(shape) {
  if (shape.kind == StrokeShape::Kind::kStep) {
    step_ = AxisMotion({0.0, 0.0, 0.0}, shape.distance, limits);
    duration_ = step_.duration();
    return;
  }
  // The product rule's worst case, of an envelope that takes a period: speed = A omega by_speed,
  // acceleration = A omega^2 by_acceleration.
  constexpr double kTurn = 2.0 * std::numbers::pi;
  constexpr double by_speed = 0.5 + kSteepest / kTurn;
  constexpr double by_acceleration = 0.5 + kSteepest / kTurn + kMostCurved / (kTurn * kTurn);
  const double amplitude = std::max(std::abs(shape.distance), 1e-12);
  omega_ = std::min(limits.max_speed / (amplitude * by_speed),
                    std::sqrt(limits.max_acceleration / (amplitude * by_acceleration)));
  duration_ = kPeriods * kTurn / omega_;
}

AxisState StrokeMotion::at(double t) const noexcept { return omega_ > 0.0 ? wave(t) : step_.at(t); }

AxisState StrokeMotion::wave(double t) const noexcept {
  if (t >= duration_) return {0.0, 0.0, 0.0};
  const double rate = omega_ / (2.0 * std::numbers::pi);  // of the envelope, 1/s
  const bool is_fading = t > duration_ / 2.0;
  AxisState s = smoothStep(rate * (is_fading ? duration_ - t : t));
  s.v *= is_fading ? -rate : rate;
  s.a *= rate * rate;
  const double c = 0.5 * (1.0 - std::cos(omega_ * t)), dc = 0.5 * omega_ * std::sin(omega_ * t);
  const double ddc = 0.5 * omega_ * omega_ * std::cos(omega_ * t);
  const double A = shape_.distance;
  return {A * s.p * c, A * (s.v * c + s.p * dc), A * (s.a * c + 2.0 * s.v * dc + s.p * ddc)};
}

void StrokeMotion::stopFrom(const AxisState& state, const MotionLimits& limits) noexcept {
  step_ = AxisMotion::stop(state, limits);
  omega_ = 0.0;
  duration_ = step_.duration();
}

}  // namespace tactus
