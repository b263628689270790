#include "tactus/control/motion_gate.h"

namespace tactus {
namespace {

/// One contact alone has the law that it had before there was a gate, to the bit.
bool isOfWholeArm(const ControllerConfig& config) {
  return config.clearance || hasContactRows(config);
}

}  // namespace

MotionGate::MotionGate(const ControllerConfig& config, const ScaledVector& inv_sqrt_weights)
    : task_size_(config.task.size),
      inv_sqrt_weights_(inv_sqrt_weights),
      joint_limits_(config.limits, isOfWholeArm(config)) {
  if (config.clearance) clearance_.emplace(config);
}

void MotionGate::add(const CommandedMotion& commanded, const TaskKinematics& kinematics,
                     double joint_share, double period_s, SpeedRows& rows) const noexcept {
  if (clearance_)
    clearance_->add(kinematics.near, kinematics, inv_sqrt_weights_, commanded.q, commanded.velocity,
                    period_s, rows);
  joint_limits_.add(commanded.q, kinematics, inv_sqrt_weights_, clearance_ ? 1.0 : joint_share,
                    rows);
}

RowVector MotionGate::keep(const CommandedMotion& commanded, const TaskKinematics& kinematics,
                           double joint_share, double period_s, SpeedRows& rows,
                           Motion& motion) const noexcept {
  add(commanded, kinematics, joint_share, period_s, rows);
  return keepSpeedRows(rows, task_size_, motion);
}

}  // namespace tactus
