#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "tactus/math/axis_motion.h"
#include "tactus/math/trajectory.h"
#include "tactus/math/types.h"

namespace tactus {

/// Of a tool that is told where to go.
struct ToolMotionLimits {
  MotionLimits position{0.1, 0.5, 5.0};   ///< m/s, m/s^2, m/s^3
  MotionLimits rotation{0.5, 2.5, 25.0};  ///< rad/s, rad/s^2, rad/s^3
};

/// All that a motion follows from, in words of 8 bytes, so that a log can hold it as it lies.
struct ToolMotionPlan {
  enum class Kind : std::uint64_t { kRest, kGo, kStop };

  std::uint64_t number = 0;  ///< another one for another motion
  Kind kind = Kind::kRest;
  double start_s = 0.0;  ///< on the reference's clock
  /// x, y, z of the tool in the base frame, m; then the rotation vector of R R_zero^T, rad.
  AxisState from[6] = {};
  double target[6] = {};      ///< kGo only
  double R_BaseZero[9] = {};  ///< by columns: the orientation that turns are counted from
  ToolMotionLimits limits;
};
/// Whether there is a motion by it: numbers are finite, limits above zero. For plans that come
/// from outside.
bool isValid(const ToolMotionPlan& plan) noexcept;

static_assert(std::is_trivially_copyable_v<ToolMotionPlan> &&
              sizeof(ToolMotionPlan) == 8 * (3 + 18 + 6 + 9 + 6));

/// Where the tool shall be, of one that is told where to go: to rest at a pose, from any motion,
/// with limited speed, acceleration and jerk. From rest it goes along a straight line, and turns
/// about a fixed axis, both at once; the limits are those of the whole position and rotation, then,
/// and as long as what it is told leads on along the same line. From any other motion each axis of
/// the base frame goes its fastest way, with the same limits. Turns have the limits of their
/// rotation vector from where they are counted, whose speed is never less than the tool's; that is
/// anew at rest, and beyond half a turn. The tool's acceleration may be some three times as much.
class ToolMotion {
 public:
  /// For ever at this pose.
  explicit ToolMotion(const Pose& X_BaseTool, std::uint64_t number = 0) noexcept;
  explicit ToolMotion(const ToolMotionPlan& plan) noexcept;

  /// From where the tool shall be at t_s to rest at a pose.
  ToolMotion to(double t_s, const Pose& X_BaseTool, const ToolMotionLimits& limits) const noexcept;
  /// From there to rest, wherever that is.
  ToolMotion stop(double t_s, const ToolMotionLimits& limits) const noexcept;

  const ToolMotionPlan& plan() const noexcept { return plan_; }
  ToolReference evaluate(double t_s) const noexcept;
  /// d/dt of the velocities of evaluate().
  ToolAcceleration evaluateAcceleration(double t_s) const noexcept;
  double end_s() const noexcept { return plan_.start_s + duration_s_; }

 private:
  struct Way {  ///< of the position, or of the rotation vector
    Vector3 p, v, a;
    bool isAtRest() const noexcept { return v.isZero(0.0) && a.isZero(0.0); }
  };

  Way wayAt(int first, double t_s) const noexcept;
  void planAxes(int first, const MotionLimits& limits) noexcept;
  double longest_s(int first) const noexcept;
  ToolMotionPlan planFrom(double t_s, const ToolMotionLimits& limits) const noexcept;

  ToolMotionPlan plan_;
  std::array<AxisMotion, 6> axes_;
  double duration_s_ = 0.0;
};

}  // namespace tactus
