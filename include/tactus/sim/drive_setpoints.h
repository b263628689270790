#pragma once

#include <cstddef>
#include <vector>

#include "tactus/sim/plant_config.h"

namespace tactus {

/// What drives make of their velocity setpoints before their loops see them: each comes late by
/// the dead time, to the part of a step, and changes no faster than the drive's own acceleration
/// limit.
class DriveSetpoints {
 public:
  /// step_s: between two updates, > 0.
  DriveSetpoints(const DriveEffectsConfig& config, int joints, double step_s);

  /// Once a step, with the setpoint of that step; m/s or rad/s.
  const JointVector& update(const JointVector& setpoint) noexcept;

 private:
  JointVector max_change_;         ///< a step; empty: any
  std::vector<JointVector> line_;  ///< setpoints under way, a ring; at least two
  std::size_t newest_ = 0;
  double late_share_;  ///< of the oldest one: the dead time is not whole steps
  JointVector reference_;
};

}  // namespace tactus
