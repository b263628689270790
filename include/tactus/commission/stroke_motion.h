#pragma once

#include <cstdint>

#include "tactus/math/axis_motion.h"

namespace tactus {

/// One small motion of a joint from rest to rest, by its time. Units: the joint's, m or rad.
struct StrokeShape {
  enum class Kind : std::uint8_t {
    kStep,  ///< there, the fastest way within the limits
    kWave,  ///< there and back four times, as a sinus that grows and fades
  };
  Kind kind = Kind::kStep;
  double distance = 0.0;  ///< signed
};

class StrokeMotion {
 public:
  StrokeMotion() = default;
  /// Speed and acceleration stay within the limits; so does the jerk of a step. A wave is as slow
  /// as its largest speed asks for, and has an acceleration far below a step's.
  StrokeMotion(const StrokeShape& shape, const MotionLimits& limits) noexcept;

  /// Where the axis is, from its start, t seconds after it; at rest from duration() on.
  AxisState at(double t) const noexcept;
  double duration() const noexcept { return duration_; }

  /// From there on to rest, the fastest way; its time starts anew.
  void stopFrom(const AxisState& state, const MotionLimits& limits) noexcept;

 private:
  AxisState wave(double t) const noexcept;

  StrokeShape shape_;
  AxisMotion step_;
  double omega_ = 0.0;  ///< of the wave, rad/s
  double duration_ = 0.0;
};

}  // namespace tactus
