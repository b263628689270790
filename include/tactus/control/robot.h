#pragma once

#include <array>
#include <cstdint>

#include "tactus/math/types.h"

namespace tactus {

/// Of one robot; its tactile modules are numbered from 0, as robot.yaml lists them.
inline constexpr int kMaxTactileModules = 8;

/// One sample of a tactile module: what pushes on the cover, in the module's frame (x along the
/// link). Forces along x are not felt.
struct TactileSample {
  double force_y_N = 0.0;
  double force_z_N = 0.0;
  double moment_y_Nm = 0.0;  ///< about the origin of the module's frame
  double moment_z_Nm = 0.0;
  std::uint32_t sequence = 0;  ///< counts samples; unchanged: the same sample as before
  double moment_x_Nm = 0.0;    ///< 0 of a module that does not tell
};

/// What a cycle reads from the robot.
struct RobotInput {
  /// m or rad. No law uses it: the arm is position-controlled; covers of modules move with it.
  JointVector q_measured;
  /// One a module; those that the robot does not have stay zero.
  std::array<TactileSample, kMaxTactileModules> tactile;
};

/// The one seam between controller and robot: simulated or real. Called from the cycle only, hence
/// without allocation, lock or exception.
class Robot {
 public:
  virtual ~Robot() = default;
  virtual void read(RobotInput& input) noexcept = 0;
  virtual void write(const JointVector& velocity_setpoint) noexcept = 0;  ///< m/s or rad/s
};

}  // namespace tactus
