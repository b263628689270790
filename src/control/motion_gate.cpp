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

/// Without the rows, whose parts in the task space cost as much as all else. A motion that keeps
/// all rows is the solution, whatever they yield.
bool MotionGate::isKept(const CommandedMotion& commanded, const TaskKinematics& kinematics,
                        double period_s, const SpeedRows& rows,
                        const Motion& motion) const noexcept {
  for (int i = 0; i < rows.size; ++i)
    if (!(speedAlong(rows.row[i], task_size_, motion) >= -rows.row[i].v_max_m_per_s)) return false;
  const ScaledVector velocity =
      inv_sqrt_weights_.cwiseProduct(motion.v_scaled + kinematics.pseudoinverse.expand(motion.y));
  return clearance_->isKept(kinematics.pose, kinematics.near, velocity, commanded.q,
                            commanded.velocity, period_s) &&
         joint_limits_.isKept(commanded.q, velocity, 1.0);
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
  if (clearance_ && isKept(commanded, kinematics, period_s, rows, motion))
    return RowVector::Zero(rows.size);
  add(commanded, kinematics, joint_share, period_s, rows);
  return RowProblem(rows, task_size_).keep(motion);
}

}  // namespace tactus
