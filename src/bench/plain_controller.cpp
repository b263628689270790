#include "tactus/bench/plain_controller.h"

#include <algorithm>

#include "tactus/math/contact_space.h"
#include "tactus/math/rotation.h"

namespace tactus {
namespace {

ScaledVector padded(const Eigen::VectorXd& v) {
  ScaledVector result = ScaledVector::Zero();
  result.head(v.size()) = v;
  return result;
}

}  // namespace

PlainController::PlainController(const BenchRobot& robot,
                                 std::unique_ptr<PlainKinematics> kinematics)
    : config_(robot.config),
      kinematics_(std::move(kinematics)),
      ones_(padded(Eigen::VectorXd::Ones(config_.chain.size()))),
      trajectory_(config_.task.trajectory, tipPose(config_.chain, config_.q_start)),
      limiter_(config_.limits),
      joint_limits_(config_.limits, ones_),
      zones_(joint_limits_.zones(config_.gains.joint_limit_avoidance)) {
  if (!config_.force_control) return;
  law_.emplace(*config_.force_control, config_.chain, ones_);
}

PlainControllerState PlainController::initialState() const {
  PlainControllerState state;
  state.q_desired = config_.q_start;
  state.velocity_before = JointVector::Zero(config_.chain.size());
  if (!law_) return state;
  state.contact_point.position_m = 0.5 * config_.tactile_modules.front().length_m;
  const double c_0 = config_.gains.force.assumed_stiffness_N_per_m;
  state.estimator.stiffness_N_per_m = state.estimator.stiffness_raw_N_per_m = c_0;
  return state;
}

/// w_eff of (2).
Eigen::VectorXd PlainController::taskVelocity(double t_s) const {
  const Pose tool = kinematics_->tool();
  const ToolReference reference = trajectory_.evaluate(t_s);
  Eigen::VectorXd w_dot(6), error(6);
  w_dot << reference.v_BaseTool, reference.omega_BaseTool;
  error << reference.p_BaseTool - tool.p_AB,
      rotationVector(reference.R_BaseTool * tool.R_AB.transpose());
  return (w_dot + config_.gains.task.drift_gain_per_s * error).head(config_.task.size);
}

/// What contact adds to the joint speeds.
Eigen::VectorXd PlainController::answer(const RobotInput& input, const Eigen::VectorXd& q_dot_eff,
                                        double period_s, PlainControllerState& state) const {
  if (input.tactile[0].sequence != state.sample_sequence)
    locateContact(input.tactile[0], config_.tactile_modules.front(), state.contact_point);
  state.sample_sequence = input.tactile[0].sequence;
  Vector3 p_BaseContact;
  const Eigen::VectorXd a = kinematics_->contactDirection(state.contact_point, p_BaseContact);
  const Eigen::VectorXd Na = kinematics_->project(a);
  ContactSpace space;
  space.a_scaled = padded(a);
  space.k_n = a.dot(Na);
  space.k_j = a.dot(a);
  space.k_t = space.k_j - space.k_n;
  const ForceGains& gains = config_.gains.force;
  ControlLawInput law_input;
  law_input.F_p_N = std::max(0.0, state.contact_point.force_N - gains.contact_threshold_N);
  estimateStiffness(gains.estimator, law_input.F_p_N, -a.dot(state.velocity_before), period_s,
                    state.estimator);
  law_input.stiffness_N_per_m = state.estimator.stiffness_N_per_m;
  law_input.integral_decay =
      passTransition(gains.transition, law_input.F_p_N, p_BaseContact, period_s, state.transition);
  law_input.x_dot_ff_m_per_s = state.transition.gamma * std::min(0.0, a.dot(q_dot_eff));
  law_input.cut_m_per_s = state.cut_m_per_s;
  state.contact_direction = a;
  ControlLawOutput u;
  law_->update(gains, law_input, space, period_s, state.law, u);
  return -(a - Na) * u.u_t - Na * u.u_n - a * u.u_j;
}

JointVector PlainController::update(const RobotInput& input, double t_s, double period_s,
                                    PlainControllerState& state) {
  kinematics_->move(state.q_desired);
  const Eigen::VectorXd q_dot_eff = kinematics_->inverse(taskVelocity(t_s));
  const Eigen::VectorXd gradient =
      joint_limits_.evaluate(zones_, state.q_desired).gradient.head(state.q_desired.size());
  Eigen::VectorXd q_dot = q_dot_eff - kinematics_->project(gradient);
  if (law_) q_dot += answer(input, q_dot_eff, period_s, state);
  JointVector velocity = q_dot;
  limiter_.apply(state.q_desired, state.velocity_before, period_s, velocity);
  if (law_) state.cut_m_per_s = std::max(0.0, state.contact_direction.dot(q_dot - velocity));
  state.velocity_before = velocity;
  state.q_desired = (state.q_desired + period_s * velocity)
                        .cwiseMax(config_.limits.lower)
                        .cwiseMin(config_.limits.upper);
  return velocity;
}

}  // namespace tactus
