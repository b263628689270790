#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/control/joint_limit_rows.h"
#include "tactus/control/speed_rows.h"

namespace tactus {

/// The one gate for all that a motion must not approach too fast: contacts, whose rows a law
/// brings, and what is known without a sensor. See docs/gate.md.
class MotionGate {
 public:
  MotionGate(const ControllerConfig& config, const ScaledVector& inv_sqrt_weights)
      : task_size_(config.task.size),
        inv_sqrt_weights_(inv_sqrt_weights),
        joint_limits_(config.limits) {}

  /// Adds what is known without a sensor. q: at the start of the cycle; joint_share: see
  /// JointLimitRows.
  void add(const JointVector& q, const TaskKinematics& kinematics, double joint_share,
           SpeedRows& rows) const noexcept {
    joint_limits_.add(q, kinematics, inv_sqrt_weights_, joint_share, rows);
  }

  /// Keeps these rows and those of add(). Returns l, in that order.
  RowVector keep(const JointVector& q, const TaskKinematics& kinematics, double joint_share,
                 SpeedRows& rows, Motion& motion) const noexcept {
    add(q, kinematics, joint_share, rows);
    return keepSpeedRows(rows, task_size_, motion);
  }

 private:
  int task_size_;
  ScaledVector inv_sqrt_weights_;
  JointLimitRows joint_limits_;
};

}  // namespace tactus
