#include "tactus/control/controller.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tactus/math/contact_space.h"
#include "tactus/math/weighted_pseudoinverse.h"

namespace tactus {
namespace {

/// All six components of a task: position or linear velocity, then rotation.
using Twist = Eigen::Matrix<double, 6, 1>;

Pose toolPose(const SerialChain& chain, const JointVector& q) {
  ChainPose pose;
  chain.computePose(q, pose);
  return framePose(pose, chain.tip());
}

Vector3 rotationVector(const Matrix3& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

bool usesOrientation(const TaskConfig& task) {
  return std::any_of(task.components.begin(), task.components.begin() + task.size,
                     [](int component) { return component >= 3; });
}

void limitNorm(double limit, Eigen::Ref<Vector3> v) {
  if (!(limit < kNoLimit)) return;
  const double norm = v.norm();
  if (norm > limit) v *= limit / norm;
}

}  // namespace

/// What depends on the desired configuration alone, and not on the contact.
struct Controller::Kinematics {
  ChainPose pose;
  WeightedPseudoinverse pseudoinverse;
  TaskVector y_eff;  ///< solve(w_dot_d,eff), (2)
};

Controller::Controller(const ControllerConfig& config)
    : config_(config),
      trajectory_(config.task.trajectory, toolPose(config.chain, config.q_start)),
      inv_sqrt_weights_(scaled(config.weights.cwiseSqrt().cwiseInverse(), ScaledVector::Ones())),
      limiter_(config.limits) {
  if (config.joint_limit_avoidance)
    joint_limit_avoidance_.emplace(*config.joint_limit_avoidance, config.limits);
  if (!config.force_control) return;
  law_.emplace(*config.force_control, config.chain, inv_sqrt_weights_);
  transition_.emplace(config.force_control->transition);
  if (config.force_control->estimator)
    estimator_.emplace(*config.force_control->estimator,
                       config.force_control->assumed_stiffness_N_per_m);
}

ControllerState Controller::initialState() const {
  ControllerState state;
  state.q_desired = config_.q_start;
  state.velocity_before = JointVector::Zero(config_.chain.size());
  if (config_.tactile_module)
    state.contact_point.position_m = 0.5 * config_.tactile_module->length_m;
  if (config_.force_control)
    state.estimator.stiffness_N_per_m = state.estimator.stiffness_raw_N_per_m =
        config_.force_control->assumed_stiffness_N_per_m;
  return state;
}

void Controller::update(const RobotInput& input, double t_s, double period_s,
                        ControllerState& state, ControllerOutput& output) const noexcept {
  Kinematics kinematics;
  computeKinematics(t_s, state, kinematics, output);

  // (1) in W^1/2 coordinates: Q y + v, with everything that goes through N or J# gathered in y.
  TaskVector y = kinematics.y_eff;
  ScaledVector v_scaled = ScaledVector::Zero();
  if (joint_limit_avoidance_) {
    JointVector gradient;
    joint_limit_avoidance_->compute(state.q_desired, gradient);
    v_scaled = -scaled(gradient, inv_sqrt_weights_);
    y -= kinematics.pseudoinverse.project(v_scaled);
  }
  output.contact = {};
  if (config_.tactile_module) {
    const Fault fault = readTactileModule(input, period_s, state);
    if (state.fault == Fault::kNone) state.fault = fault;
    output.contact.force_sensor_N = state.contact_point.force_N;
    output.contact.contact_position_m = state.contact_point.position_m;
    output.contact.contact_direction = state.contact_point.direction;
  }
  if (law_) answerContact(kinematics, period_s, state, output.contact, y, v_scaled);

  v_scaled += kinematics.pseudoinverse.expand(y);
  v_scaled.array() *= inv_sqrt_weights_.array();
  output.velocity = v_scaled.head(config_.chain.size());
  if (state.fault != Fault::kNone) output.velocity.setZero();
  const bool finite =
      limiter_.apply(state.q_desired, state.velocity_before, period_s, output.velocity);
  if (!finite) state.fault = Fault::kCommandNotFinite;

  output.fault = state.fault;
  output.q_desired = state.q_desired;
  for (int i = 0; i < config_.chain.size(); ++i) {
    const double q = state.q_desired[i] + period_s * output.velocity[i];
    state.q_desired[i] = std::clamp(q, config_.limits.lower[i], config_.limits.upper[i]);
    state.velocity_before[i] = output.velocity[i];
  }
}

void Controller::computeKinematics(double t_s, const ControllerState& state, Kinematics& kinematics,
                                   ControllerOutput& output) const noexcept {
  const TaskConfig& task = config_.task;
  config_.chain.computePose(state.q_desired, kinematics.pose);
  const ToolReference reference = trajectory_.evaluate(t_s);
  Twist w = Twist::Zero();
  Twist w_d_dot;
  Twist error = Twist::Zero();
  w.head<3>() = framePosition(kinematics.pose, config_.chain.tip());
  error.head<3>() = reference.p_BaseTool - w.head<3>();
  w_d_dot << reference.v_BaseTool, reference.omega_BaseTool;
  if (usesOrientation(task)) {
    const Matrix3 R_BaseTool = framePose(kinematics.pose, config_.chain.tip()).R_AB;
    w.tail<3>() = rotationVector(R_BaseTool);
    error.tail<3>() = rotationVector(reference.R_BaseTool * R_BaseTool.transpose());
  }
  Twist drift = task.drift_gain_per_s * error;
  limitNorm(task.max_drift_speed, drift.head<3>());
  limitNorm(task.max_drift_speed, drift.tail<3>());

  TaskJacobian J;
  computeTipJacobian(config_.chain, kinematics.pose, w.head<3>(), task.components.data(), task.size,
                     J);
  kinematics.pseudoinverse.factorise(J, inv_sqrt_weights_);
  TaskVector w_dot_eff(task.size);
  output.w.resize(task.size);
  output.w_d.resize(task.size);
  output.w_d_dot.resize(task.size);
  for (int i = 0; i < task.size; ++i) {
    const int component = task.components[i];
    w_dot_eff[i] = w_d_dot[component] + drift[component];
    output.w[i] = w[component];
    output.w_d[i] = w[component] + error[component];
    output.w_d_dot[i] = w_d_dot[component];
  }
  kinematics.y_eff = kinematics.pseudoinverse.solve(w_dot_eff);
}

Fault Controller::readTactileModule(const RobotInput& input, double period_s,
                                    ControllerState& state) const noexcept {
  const TactileModuleConfig& module = *config_.tactile_module;
  if (input.tactile.sequence == state.sample_sequence) {
    state.sample_age_s += period_s;
    return state.sample_age_s > module.max_sample_age_s ? Fault::kTactileStale : Fault::kNone;
  }
  state.sample_sequence = input.tactile.sequence;
  state.sample_age_s = 0.0;
  if (!isValid(input.tactile, module)) return Fault::kTactileInvalid;
  locateContact(input.tactile, module.length_m, state.contact_point);
  return Fault::kNone;
}

void Controller::answerContact(const Kinematics& kinematics, double period_s,
                               ControllerState& state, ContactReport& report, TaskVector& y,
                               ScaledVector& v_scaled) const noexcept {
  const ForceControlConfig& force_control = *config_.force_control;
  const AttachedFrame& link = config_.tactile_module->link;
  const Pose X_BaseModule = framePose(kinematics.pose, link);
  const Vector3 p_BaseContact =
      X_BaseModule.p_AB + state.contact_point.position_m * X_BaseModule.R_AB.col(0);
  const Vector3 F_Base = X_BaseModule.R_AB.lazyProduct(state.contact_point.direction);
  JointVector a;
  applyPointJacobianTranspose(config_.chain, kinematics.pose, link.joint, p_BaseContact, F_Base, a);
  ContactSpace space;
  computeContactSpace(kinematics.pseudoinverse, a, inv_sqrt_weights_, kinematics.y_eff, space);

  ControlLawInput law_input;
  law_input.F_p_N = std::max(0.0, state.contact_point.force_N - force_control.contact_threshold_N);
  if (estimator_)
    estimator_->update(law_input.F_p_N, -a.dot(state.velocity_before), period_s, state.estimator);
  law_input.stiffness_N_per_m = state.estimator.stiffness_N_per_m;
  law_input.integral_decay =
      transition_->update(law_input.F_p_N, p_BaseContact, period_s, state.transition);
  law_input.x_dot_ff_m_per_s = state.transition.gamma * std::min(space.x_dot_eff_m_per_s, 0.0);
  ControlLawOutput u;
  law_->update(law_input, space, period_s, state.law, u);

  // J# J b u_t = W^-1/2 Q (Q^T a^) u_t needs no inverse, so it is exact in singular poses, too.
  y += (u.u_n - u.u_t) * space.a_task;
  v_scaled -= (u.u_n + u.u_j) * space.a_scaled;

  report.force_contact_N = law_input.F_p_N;
  report.stiffness_N_per_m = state.estimator.stiffness_N_per_m;
  report.stiffness_raw_N_per_m = state.estimator.stiffness_raw_N_per_m;
  report.gamma = state.transition.gamma;
  report.k_n = space.k_n;
  report.k_j = space.k_j;
  report.k_t = space.k_t;
  report.x_dot_eff_m_per_s = space.x_dot_eff_m_per_s;
  report.u_n = u.u_n;
  report.u_j = u.u_j;
  report.u_t = u.u_t;
}

const char* faultName(Fault fault) noexcept {
  switch (fault) {
    case Fault::kNone:
      return "none";
    case Fault::kTactileInvalid:
      return "tactile_invalid";
    case Fault::kTactileStale:
      return "tactile_stale";
    case Fault::kCommandNotFinite:
      return "command_not_finite";
  }
  return "unknown";
}

}  // namespace tactus
