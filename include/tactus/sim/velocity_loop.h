#pragma once

#include "tactus/sim/plant_config.h"

namespace tactus {

/// A drive whose velocity follows its setpoint as a second-order low pass, so that its position
/// follows the integral of the setpoint:
///   q_ddot = w^2 (q_d - q) - 2 d w q_dot,    w = 2 pi bandwidth
/// Exact for a q_d that stands still within a step.
class VelocityLoop {
 public:
  /// At rest at q. step_s: > 0.
  VelocityLoop(const VelocityLoopConfig& config, const JointVector& q, double step_s);

  /// One step towards q_d; q: of the drives, m or rad.
  void update(const JointVector& q_d, JointVector& q) noexcept;

 private:
  Eigen::Matrix2d step_;  ///< of (q - q_d, q_dot)
  JointVector velocity_;
};

}  // namespace tactus
