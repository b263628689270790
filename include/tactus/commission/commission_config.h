#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tactus/canopen/hardware_config.h"
#include "tactus/math/types.h"

namespace tactus {

/// What the engineer allows a motion; of one kind of joint, m or rad.
struct MotionBounds {
  double max_travel;           ///< of one motion
  double max_speed;            ///< 1/s
  double max_acceleration;     ///< 1/s^2
  double max_following_error;  ///< more ends the motion
  double measuring_error;      ///< of a place that the engineer measures, at most
  double margin;               ///< kept from a joint's ends
  double unseen;               ///< a motion that the engineer does not see is shorter than this
};

/// Defaults, and what no argument exceeds.
inline constexpr MotionBounds kRevoluteBounds{0.1, 0.05, 0.5, 0.02, 0.0035, 0.05, 0.035};
inline constexpr MotionBounds kPrismaticBounds{0.02, 0.01, 0.1, 0.004, 0.0005, 0.005, 0.002};
inline constexpr double kMostTravel_rad = 0.1, kMostSpeed_rad_per_s = 0.1;
inline constexpr double kMostTravel_m = 0.02, kMostSpeed_m_per_s = 0.02;

struct CommissionConfig {
  HardwareConfig hardware;         ///< as robot.yaml has it
  std::vector<bool> is_prismatic;  ///< one a joint, as all that follow
  double period_s = 0.001;
  MotionBounds revolute = kRevoluteBounds, prismatic = kPrismaticBounds;
  /// A joint has at least the file's counts a unit, divided by this, before anything was measured.
  double file_factor = 10.0;

  int joints() const noexcept { return static_cast<int>(is_prismatic.size()); }
  const MotionBounds& bounds(int joint) const noexcept {
    return is_prismatic[joint] ? prismatic : revolute;
  }
};

}  // namespace tactus
