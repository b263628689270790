#include <algorithm>

#include "tactus/control/clearance_cost.h"
#include "tactus/control/controller.h"

/// How an arm keeps clear of itself and of what is around it, and of its joints' limits.
namespace tactus {

void Controller::lookAround(const ControllerState& state, PreparedCycle& prepared) const noexcept {
  const TaskKinematics& kinematics = prepared.kinematics;
  clearance_->findNear(kinematics.pose, prepared.near);
  const std::optional<ClearanceAvoidance>& avoid = config_.clearance->avoid;
  if (!avoid || prepared.near.size == 0) return;
  const ScaledVector cost =
      state.return_share * clearanceCost(*avoid, prepared.near, inv_sqrt_weights_);
  prepared.motion.v_scaled -= cost;
  prepared.motion.y += kinematics.pseudoinverse.project(cost);
}

/// Those of a motion that a contact has nothing to do with.
void Controller::addKeptRows(const PreparedCycle& prepared, double period_s,
                             const ControllerState& state, SpeedRows& rows) const noexcept {
  if (clearance_)
    clearance_->add(prepared.near, prepared.kinematics, inv_sqrt_weights_, state.q_desired,
                    state.velocity_before, period_s, rows);
  limit_rows_.add(state.q_desired, prepared.kinematics, inv_sqrt_weights_, 1.0, rows);
}

/// Returns what that takes from the contact point's retreat, m/s.
double Controller::keepClear(double period_s, const ControllerState& state,
                             PreparedCycle& prepared) const noexcept {
  SpeedRows rows;
  addKeptRows(prepared, period_s, state, rows);
  Motion& motion = prepared.motion;
  const Motion before = motion;
  const RowVector l = keepSpeedRows(rows, config_.task.size, motion);
  if (!contact_controller_ || l.isZero(0.0)) return 0.0;
  const ScaledVector a_scaled = motion.a.cwiseProduct(inv_sqrt_weights_);
  const PaddedTaskVector a_task = prepared.kinematics.pseudoinverse.project(a_scaled);
  return std::max(0.0, dot(a_scaled, ScaledVector(before.v_scaled - motion.v_scaled)) +
                           dot(a_task, PaddedTaskVector(before.y - motion.y), config_.task.size));
}

}  // namespace tactus
