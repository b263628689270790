#include "tactus/control/controller.h"
#include "tactus/math/velocity_product.h"

/// What the acceleration level asks of a controller.
namespace tactus {

/// The reference's acceleration counts with the square of its progress, as its clock is slower; how
/// the progress itself changes, and a return speed that holds beta's correction constant, are left
/// to k_v.
FreeAcceleration Controller::freeAcceleration(const Gains& gains, double path_time_s,
                                              double period_s, const PreparedCycle& prepared,
                                              ControllerState& state) const noexcept {
  const TaskKinematics& kinematics = prepared.kinematics;
  FreeAcceleration free;
  free.v_before =
      scaled(state.velocity_before.cwiseQuotient(inv_sqrt_weights_.head(config_.chain.size())),
             ScaledVector::Ones());
  free.y_before = kinematics.pseudoinverse.project(free.v_before);

  const AttachedFrame& tip = config_.chain.tip();
  const VelocityProduct curvature =
      velocityProduct(config_.chain, kinematics.pose, tip.joint,
                      framePosition(kinematics.pose, tip), state.velocity_before);
  const ToolAcceleration reference = referenceAcceleration(path_time_s, state);
  const TaskVector w_dot = kinematics.pseudoinverse.taskVelocity(free.y_before);
  const double beta = state.return_share * gains.task.drift_gain_per_s;
  const double progress = prepared.progress * prepared.progress;
  free.w_dd.setZero();
  for (int i = 0; i < config_.task.size; ++i) {
    const int k = config_.task.components[i] % 3;
    const bool is_position = config_.task.components[i] < 3;
    free.w_dd[i] =
        progress * (is_position ? reference.a_BaseTool[k] : reference.alpha_BaseTool[k]) -
        (is_position ? curvature.linear[k] : curvature.angular[k]) +
        beta * (prepared.w_d_dot[i] - w_dot[i]);
  }

  free.cost_change.setZero();
  if (!joint_limit_avoidance_) return free;
  const JointVector q_before = state.q_desired - period_s * state.velocity_before;
  free.cost_change = state.return_share * (costAt(q_before, gains, state).gradient -
                                           costAt(state.q_desired, gains, state).gradient);
  return free;
}

}  // namespace tactus
