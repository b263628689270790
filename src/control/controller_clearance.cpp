#include <algorithm>

#include "tactus/control/clearance_cost.h"
#include "tactus/control/controller.h"

/// How an arm keeps clear of itself and of what is around it.
namespace tactus {

void Controller::lookAround(const ControllerState& state, PreparedCycle& prepared) const noexcept {
  TaskKinematics& kinematics = prepared.kinematics;
  gate_.clearance()->findNear(kinematics.pose, kinematics.near);
  const std::optional<ClearanceAvoidance>& avoid = config_.clearance->avoid;
  if (!avoid || kinematics.near.size == 0) return;
  const ScaledVector cost =
      state.return_share * clearanceCost(*avoid, gate_.clearance()->distances(), kinematics.pose,
                                         kinematics.near, inv_sqrt_weights_);
  prepared.motion.v_scaled -= cost;
  prepared.motion.y += kinematics.pseudoinverse.project(cost);
}

/// For laws that bring no rows of their own. Returns what that takes from the contact point's
/// retreat, m/s.
double Controller::keepClear(const TaskKinematics& kinematics, double period_s,
                             const ControllerState& state, Motion& motion) const noexcept {
  SpeedRows rows;
  const Motion before = motion;
  const RowVector l = gate_.keep({state.q_desired, state.velocity_before, true}, kinematics, 1.0,
                                 period_s, rows, motion);
  if (!contact_controller_ || l.isZero(0.0)) return 0.0;
  const ScaledVector a_scaled = motion.a.cwiseProduct(inv_sqrt_weights_);
  const PaddedTaskVector a_task = kinematics.pseudoinverse.project(a_scaled);
  return std::max(0.0, dot(a_scaled, ScaledVector(before.v_scaled - motion.v_scaled)) +
                           dot(a_task, PaddedTaskVector(before.y - motion.y), config_.task.size));
}

}  // namespace tactus
