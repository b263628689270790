#pragma once

#include <array>

namespace tactus {

/// Limits of a motion along one axis, each > 0. Units: the axis's, m or rad.
struct MotionLimits {
  double max_speed;         ///< 1/s
  double max_acceleration;  ///< 1/s^2
  double max_jerk;          ///< 1/s^3
};

struct AxisState {
  double p, v, a;  ///< place, speed, acceleration
};

/// The fastest motion of one axis from any state to rest at a target, within limits of speed,
/// acceleration and jerk. Where speed or acceleration at the start are above a limit, they come
/// below it first, as fast as the others allow.
///   With V the largest speed towards the target: the axis changes its speed to V, the fastest way,
///   and stops, the fastest way, at the moment from which a stop ends at the target; if V is
///   reached before, it keeps V in between. For an end at rest there is no faster one, as the place
///   where a stop would end only moves on while the axis speeds up. The moment is found by
///   bisection, for the polynomials that it is a root of have no root that doubles could tell.
///   R. Haschke, E. Weitnauer, H. Ritter, "On-Line Planning of Time-Optimal, Jerk-Limited
///   Trajectories", IROS 2008, has the same idea for the speed at the peak.
class AxisMotion {
 public:
  /// At rest, for ever.
  explicit AxisMotion(double p = 0.0) noexcept : target_(p) {}
  AxisMotion(const AxisState& from, double target, const MotionLimits& limits) noexcept;

  /// To rest, the fastest way, wherever that is.
  static AxisMotion stop(const AxisState& from, const MotionLimits& limits) noexcept;

  /// t seconds after the start, t >= 0; exactly at rest at the target from duration() on.
  AxisState at(double t) const noexcept;
  double jerk(double t) const noexcept;
  double duration() const noexcept { return duration_; }
  double target() const noexcept { return target_; }

 private:
  struct Phase {
    double start;
    AxisState from;
    double jerk;
  };

  void append(double duration, double jerk) noexcept;
  void appendStop(const MotionLimits& limits) noexcept;

  std::array<Phase, 7> phases_;  ///< to V three, at V one, to rest three
  int size_ = 0;
  double duration_ = 0.0;
  double target_;
  AxisState end_{};  ///< of the phases so far, while they are appended
};

}  // namespace tactus
