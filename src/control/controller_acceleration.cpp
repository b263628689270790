#include "tactus/control/controller.h"

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
  const Vector3 linear = progress * reference.a_BaseTool - curvature.linear;
  const Vector3 alpha_d = progress * reference.alpha_BaseTool;
  const Vector3 angular = has_part_of_rotation_
                              ? partOfRotationAcceleration(path_time_s, prepared.progress, alpha_d,
                                                           curvature, kinematics.pose, state)
                              : Vector3(alpha_d - curvature.angular);
  free.w_dd.setZero();
  for (int i = 0; i < config_.task.size; ++i) {
    const int k = config_.task.components[i] % 3;
    free.w_dd[i] = (config_.task.components[i] < 3 ? linear[k] : angular[k]) +
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
