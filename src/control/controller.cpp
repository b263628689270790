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

}  // namespace

/// What depends on the desired configuration alone, and not on the contact.
struct Controller::Kinematics {
  ChainPose pose;
  WeightedPseudoinverse pseudoinverse;
  TaskVector y_eff;   ///< solve(w_dot_d,eff), (2)
  TaskVector y_pull;  ///< solve(beta_pull (w_d - w)), joint space only
};

/// The motion equation (1) as it comes together: q_dot = W^-1/2 (Q y + v_scaled), with everything
/// that goes through N or J# gathered in y.
struct Controller::Motion {
  TaskVector y;
  ScaledVector v_scaled = ScaledVector::Zero();
  double limit_nearness = 0.0;  ///< s_max of the joint-limit cost, 0 to 1
};

/// A contact as the joints see it.
struct Controller::Contact {
  Vector3 p_Base;
  JointVector a;  ///< J_p^T F^
  ContactSpace space;
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
  if (config.force_control->variant == Variant::kJointSpace) {
    joint_space_transition_.emplace(*config.force_control);
  } else {
    transition_.emplace(config.force_control->transition);
  }
  if (config.force_control->estimator)
    estimator_.emplace(*config.force_control->estimator,
                       config.force_control->assumed_stiffness_N_per_m);
}

ControllerState Controller::initialState() const {
  ControllerState state;
  state.q_desired = config_.q_start;
  state.velocity_before = JointVector::Zero(config_.chain.size());
  if (config_.tactile_module)
    state.contact_point.position_m = state.joint_space_transition.contact.position_m =
        0.5 * config_.tactile_module->length_m;
  if (config_.force_control)
    state.estimator.stiffness_N_per_m = state.estimator.stiffness_raw_N_per_m =
        config_.force_control->assumed_stiffness_N_per_m;
  return state;
}

void Controller::update(const RobotInput& input, double t_s, double period_s,
                        ControllerState& state, ControllerOutput& output) const noexcept {
  Kinematics kinematics;
  computeKinematics(t_s, state, kinematics, output);

  Motion motion;
  motion.y = kinematics.y_eff;
  if (joint_limit_avoidance_) avoidJointLimits(kinematics, state, motion);
  output.contact = {};
  if (config_.tactile_module) {
    const Fault fault = readTactileModule(input, period_s, state);
    if (state.fault == Fault::kNone) state.fault = fault;
    output.contact.force_sensor_N = state.contact_point.force_N;
    output.contact.contact_position_m = state.contact_point.position_m;
    output.contact.contact_direction = state.contact_point.direction;
  }
  if (law_) answerContact(kinematics, period_s, state, output.contact, motion);

  motion.v_scaled += kinematics.pseudoinverse.expand(motion.y);
  motion.v_scaled.array() *= inv_sqrt_weights_.array();
  output.velocity = motion.v_scaled.head(config_.chain.size());
  limit(period_s, state, output);
}

void Controller::limit(double period_s, ControllerState& state,
                       ControllerOutput& output) const noexcept {
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

void Controller::avoidJointLimits(const Kinematics& kinematics, const ControllerState& state,
                                  Motion& motion) const noexcept {
  JointVector gradient;
  motion.limit_nearness = joint_limit_avoidance_->compute(state.q_desired, gradient);
  motion.v_scaled = -scaled(gradient, inv_sqrt_weights_);
  motion.y -= kinematics.pseudoinverse.project(motion.v_scaled);
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
  TaskJacobian J;
  computeTipJacobian(config_.chain, kinematics.pose, w.head<3>(), task.components.data(), task.size,
                     J);
  kinematics.pseudoinverse.factorise(J, inv_sqrt_weights_);
  TaskVector task_error(task.size);
  output.w.resize(task.size);
  output.w_d_dot.resize(task.size);
  for (int i = 0; i < task.size; ++i) {
    const int component = task.components[i];
    task_error[i] = error[component];
    output.w[i] = w[component];
    output.w_d_dot[i] = w_d_dot[component];
  }
  output.w_d = output.w + task_error;
  kinematics.y_eff =
      kinematics.pseudoinverse.solve(output.w_d_dot + task.drift_gain_per_s * task_error);
  if (joint_space_transition_)
    kinematics.y_pull =
        kinematics.pseudoinverse.solve(config_.force_control->pull_gain_per_s * task_error);
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

void Controller::locate(const Kinematics& kinematics, const ContactPointState& point,
                        Contact& contact) const noexcept {
  const AttachedFrame& link = config_.tactile_module->link;
  const Pose X_BaseModule = framePose(kinematics.pose, link);
  const Vector3 F_Base = X_BaseModule.R_AB.lazyProduct(point.direction);
  contact.p_Base = X_BaseModule.p_AB + point.position_m * X_BaseModule.R_AB.col(0);
  applyPointJacobianTranspose(config_.chain, kinematics.pose, link.joint, contact.p_Base, F_Base,
                              contact.a);
  computeContactSpace(kinematics.pseudoinverse, contact.a, inv_sqrt_weights_, kinematics.y_eff,
                      contact.space);
}

void Controller::answerContact(const Kinematics& kinematics, double period_s,
                               ControllerState& state, ContactReport& report,
                               Motion& motion) const noexcept {
  if (joint_space_transition_)
    joint_space_transition_->follow(state.contact_point, period_s, state.joint_space_transition);
  Contact contact;
  locate(kinematics,
         joint_space_transition_ ? state.joint_space_transition.contact : state.contact_point,
         contact);

  ControlLawInput law_input;
  law_input.F_p_N =
      std::max(0.0, state.contact_point.force_N - config_.force_control->contact_threshold_N);
  if (estimator_) {
    const double approach_m_per_s = -contact.a.dot(state.velocity_before);  // (15)
    estimator_->update(law_input.F_p_N, approach_m_per_s, period_s, state.estimator);
  }
  law_input.stiffness_N_per_m = state.estimator.stiffness_N_per_m;
  if (joint_space_transition_) {
    passJointSpaceTransition(kinematics, contact, period_s, state, report, law_input, motion);
  } else {
    passTransition(contact, period_s, state, report, law_input);
  }
  ControlLawOutput u;
  law_->update(law_input, contact.space, period_s, state.law, u);

  // J# J b u_t = W^-1/2 Q (Q^T a^) u_t needs no inverse, so it is exact in singular poses, too.
  motion.y += (u.u_n - u.u_t) * contact.space.a_task;
  motion.v_scaled -= (u.u_n + u.u_j) * contact.space.a_scaled;

  report.force_contact_N = law_input.F_p_N;
  report.stiffness_N_per_m = state.estimator.stiffness_N_per_m;
  report.stiffness_raw_N_per_m = state.estimator.stiffness_raw_N_per_m;
  report.k_n = contact.space.k_n;
  report.k_j = contact.space.k_j;
  report.k_t = contact.space.k_t;
  report.u_n = u.u_n;
  report.u_j = u.u_j;
  report.u_t = u.u_t;
}

void Controller::passTransition(const Contact& contact, double period_s, ControllerState& state,
                                ContactReport& report, ControlLawInput& law_input) const noexcept {
  const double x_dot_eff = contact.space.x_dot_eff_m_per_s;
  law_input.integral_decay =
      transition_->update(law_input.F_p_N, contact.p_Base, period_s, state.transition);
  law_input.x_dot_ff_m_per_s = state.transition.gamma * std::min(x_dot_eff, 0.0);
  report.gamma = state.transition.gamma;
  report.x_dot_eff_m_per_s = x_dot_eff;
}

void Controller::passJointSpaceTransition(const Kinematics& kinematics, const Contact& contact,
                                          double period_s, ControllerState& state,
                                          ContactReport& report, ControlLawInput& law_input,
                                          Motion& motion) const noexcept {
  JointSpaceTransitionState& transition = state.joint_space_transition;
  const ContactSpace& space = contact.space;
  const double x_free = space.a_task.dot(motion.y) + space.a_scaled.dot(motion.v_scaled);
  const double share = law_->speedShare(kinematics.pseudoinverse.expand(kinematics.y_pull)) *
                       (1.0 - motion.limit_nearness * motion.limit_nearness);
  const TaskVector y_pull = share * kinematics.y_pull;
  const IntegralShare integral = joint_space_transition_->update(
      {law_input.F_p_N, contact.p_Base, x_free}, period_s, transition);
  const double x_pull = space.a_task.dot(y_pull);
  law_input.integral_decay = integral.decay;
  law_input.integral_share = integral.share;
  law_input.x_dot_ff_m_per_s = std::min(0.0, transition.gamma * x_free + transition.kappa * x_pull);
  motion.y += transition.kappa * y_pull;
  report.gamma = transition.gamma;
  report.x_dot_eff_m_per_s = x_free + transition.kappa * x_pull;
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
