#include "tactus/control/controller.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tactus/math/rotation.h"

namespace tactus {
namespace {

/// All six components of a task: position or linear velocity, then rotation.
using Twist = Eigen::Matrix<double, 6, 1>;

Pose toolPose(const SerialChain& chain, const JointVector& q) {
  ChainPose pose;
  chain.computePose(q, pose);
  return framePose(pose, chain.tip());
}

bool usesOrientation(const TaskConfig& task) {
  return std::any_of(task.components.begin(), task.components.begin() + task.size,
                     [](int component) { return component >= 3; });
}

}  // namespace

Controller::Controller(const ControllerConfig& config)
    : config_(config),
      trajectory_(config.task.trajectory, toolPose(config.chain, config.q_start)),
      inv_sqrt_weights_(scaled(config.weights.cwiseSqrt().cwiseInverse(), ScaledVector::Ones())),
      uses_orientation_(usesOrientation(config.task)),
      limiter_(config.limits) {
  if (config.joint_limit_avoidance)
    joint_limit_avoidance_.emplace(*config.joint_limit_avoidance, config.limits, inv_sqrt_weights_);
  if (!config.force_control) return;
  if (!config.tactile_module) throw std::invalid_argument("force control needs a tactile module");
  contact_controller_.emplace(config, inv_sqrt_weights_);
}

ControllerState Controller::initialState(const JointVector& q) const {
  ControllerState state;
  state.q_desired = q.cwiseMax(config_.limits.lower).cwiseMin(config_.limits.upper);
  state.velocity_before = JointVector::Zero(config_.chain.size());
  if (config_.tactile_module)
    state.contact_point.position_m = 0.5 * config_.tactile_module->length_m;
  if (contact_controller_) state.contact = contact_controller_->initialState();
  return state;
}

void Controller::update(const RobotInput& input, double t_s, double period_s,
                        ControllerState& state, ControllerOutput& output) const noexcept {
  PreparedCycle prepared;
  computeMotion(t_s, state, prepared);
  respond(input, period_s, prepared, state, output);
}

void Controller::prepare(double t_s, const ControllerState& state,
                         PreparedCycle& prepared) const noexcept {
  computeMotion(t_s, state, prepared);
  prepared.t_s = t_s;
  prepared.q_desired = state.q_desired;
}

void Controller::update(const RobotInput& input, double t_s, double period_s,
                        PreparedCycle& prepared, ControllerState& state,
                        ControllerOutput& output) const noexcept {
  if (prepared.t_s != t_s || prepared.q_desired != state.q_desired)
    computeMotion(t_s, state, prepared);
  prepared.t_s = std::numeric_limits<double>::quiet_NaN();
  respond(input, period_s, prepared, state, output);
}

void Controller::computeMotion(double t_s, const ControllerState& state,
                               PreparedCycle& prepared) const noexcept {
  computeKinematics(t_s, state, prepared);
  Motion& motion = prepared.motion;
  motion.y = prepared.kinematics.y_eff;
  if (joint_limit_avoidance_) {
    avoidJointLimits(prepared.kinematics, state, motion);
  } else {
    motion.v_scaled.setZero();
  }
}

void Controller::respond(const RobotInput& input, double period_s, PreparedCycle& prepared,
                         ControllerState& state, ControllerOutput& output) const noexcept {
  const TaskKinematics& kinematics = prepared.kinematics;
  Motion& motion = prepared.motion;
  output.w = prepared.w;
  output.w_d = prepared.w + kinematics.error;
  output.w_d_dot = prepared.w_d_dot;
  output.contact = {};
  if (config_.tactile_module) {
    const Fault fault = readTactileModule(input, period_s, state);
    if (state.fault == Fault::kNone) state.fault = fault;
    output.contact.force_sensor_N = state.contact_point.force_N;
    output.contact.contact_position_m = state.contact_point.position_m;
    output.contact.contact_direction = state.contact_point.direction;
  }
  if (contact_controller_)
    contact_controller_->update(kinematics, state.contact_point,
                                {state.q_desired, state.velocity_before}, period_s, state.contact,
                                output.contact, motion);

  motion.v_scaled += kinematics.pseudoinverse.expand(motion.y);
  motion.v_scaled.array() *= inv_sqrt_weights_.array();
  output.velocity = motion.v_scaled.head(config_.chain.size());
  limit(period_s, state, output);
}

void Controller::coast(int missed_cycles, double period_s, ControllerState& state) const noexcept {
  moveDesired(missed_cycles * period_s, state);
}

void Controller::limit(double period_s, ControllerState& state,
                       ControllerOutput& output) const noexcept {
  if (state.fault != Fault::kNone || state.is_stopping) output.velocity.setZero();
  const bool finite =
      limiter_.apply(state.q_desired, state.velocity_before, period_s, output.velocity);
  if (!finite) state.fault = Fault::kCommandNotFinite;

  output.fault = state.fault;
  output.q_desired = state.q_desired;
  state.velocity_before = output.velocity;
  moveDesired(period_s, state);
}

void Controller::moveDesired(double duration_s, ControllerState& state) const noexcept {
  for (int i = 0; i < config_.chain.size(); ++i) {
    const double q = state.q_desired[i] + duration_s * state.velocity_before[i];
    state.q_desired[i] = std::clamp(q, config_.limits.lower[i], config_.limits.upper[i]);
  }
}

void Controller::avoidJointLimits(const TaskKinematics& kinematics, const ControllerState& state,
                                  Motion& motion) const noexcept {
  const JointLimitCost cost = joint_limit_avoidance_->evaluate(state.q_desired);
  motion.limit_nearness = cost.nearness;
  motion.v_scaled = -cost.gradient;
  motion.y -= kinematics.pseudoinverse.project(motion.v_scaled);
}

void Controller::computeKinematics(double t_s, const ControllerState& state,
                                   PreparedCycle& prepared) const noexcept {
  const TaskConfig& task = config_.task;
  TaskKinematics& kinematics = prepared.kinematics;
  config_.chain.computePose(state.q_desired, kinematics.pose);
  const ToolReference reference = trajectory_.evaluate(t_s);
  Twist w = Twist::Zero();
  Twist w_d_dot;
  Twist error = Twist::Zero();
  w.head<3>() = framePosition(kinematics.pose, config_.chain.tip());
  error.head<3>() = reference.p_BaseTool - w.head<3>();
  w_d_dot << reference.v_BaseTool, reference.omega_BaseTool;
  if (uses_orientation_) {
    const Matrix3 R_BaseTool = framePose(kinematics.pose, config_.chain.tip()).R_AB;
    w.tail<3>() = rotationVector(R_BaseTool);
    error.tail<3>() = rotationVector(reference.R_BaseTool * R_BaseTool.transpose());
  }
  TaskJacobian J;
  computeTipJacobian(config_.chain, kinematics.pose, w.head<3>(), task.components.data(), task.size,
                     J);
  kinematics.pseudoinverse.factorise(J, inv_sqrt_weights_);
  kinematics.error.resize(task.size);
  prepared.w.resize(task.size);
  prepared.w_d_dot.resize(task.size);
  for (int i = 0; i < task.size; ++i) {
    const int component = task.components[i];
    kinematics.error[i] = error[component];
    prepared.w[i] = w[component];
    prepared.w_d_dot[i] = w_d_dot[component];
  }
  kinematics.y_eff =
      kinematics.pseudoinverse.solve(prepared.w_d_dot + task.drift_gain_per_s * kinematics.error);
}

Fault Controller::readTactileModule(const RobotInput& input, double period_s,
                                    ControllerState& state) const noexcept {
  const TactileModuleConfig& module = *config_.tactile_module;
  state.contact_point.interval_s = 0.0;
  if (input.tactile.sequence == state.sample_sequence) {
    state.sample_age_s += period_s;
    return state.sample_age_s > module.max_sample_age_s ? Fault::kTactileStale : state.sample_fault;
  }
  state.sample_sequence = input.tactile.sequence;
  const double interval_s = state.sample_age_s + period_s;
  state.sample_age_s = 0.0;
  const bool is_valid = isValid(input.tactile, module);
  state.sample_fault = is_valid ? Fault::kNone : Fault::kTactileInvalid;
  if (is_valid) {
    locateContact(input.tactile, module.length_m, state.contact_point);
    state.contact_point.interval_s = interval_s;
  }
  return state.sample_fault;
}

}  // namespace tactus
