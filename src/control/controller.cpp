#include "tactus/control/controller.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tactus/control/path_progress.h"
#include "tactus/control/return_speed.h"
#include "tactus/math/rotation.h"

namespace tactus {
namespace {

/// All six components of a task: position or linear velocity, then rotation.
using Twist = Eigen::Matrix<double, 6, 1>;

/// The reference's rotation vector in place of a sum of two, which is no rotation.
void replaceRotation(const TaskConfig& task, const Vector3& rotation_vector,
                     TaskVector& w) noexcept {
  for (int i = 0; i < task.size; ++i)
    if (task.components[i] >= 3) w[i] = rotation_vector[task.components[i] - 3];
}

/// Hazard: a ramp to rest that went on only in the cycles that are there would last longer by as
/// much as the loop is too slow.
void rampOn(const JointLimits& limits, double duration_s, JointVector& velocity) noexcept {
  const JointVector most = duration_s * limits.max_acceleration;
  velocity -= velocity.cwiseMax(-most).cwiseMin(most);
}

void lower(const JointLimitCost& cost, const TaskKinematics& kinematics,
           const ControllerState& state, Motion& motion) noexcept {
  motion.limit_nearness = cost.nearness;
  motion.v_scaled = -cost.gradient;
  if (state.return_share < 1.0)
    softenWayOut(state.return_share,
                 state.is_leaning ? state.way_out_before : ScaledVector(ScaledVector::Zero()),
                 state.way_out_added, motion.v_scaled);
  motion.y -= kinematics.pseudoinverse.project(motion.v_scaled);
}

}  // namespace

Controller::Controller(const ControllerConfig& config)
    : config_(config),
      trajectory_(config.task.trajectory, tipPose(config.chain, config.q_start)),
      inv_sqrt_weights_(scaled(config.weights.cwiseSqrt().cwiseInverse(), ScaledVector::Ones())),
      has_rotation_(config.task.hasRotation()),
      has_part_of_rotation_(config.task.hasPartOfRotation()),
      is_acceleration_level_(config.force_control &&
                             config.force_control->level == ControlLevel::kAcceleration),
      limiter_(config.limits),
      gate_(config, inv_sqrt_weights_) {
  if (config.has_joint_limit_avoidance)
    joint_limit_avoidance_.emplace(config.limits, inv_sqrt_weights_);
  if (config.q_posture && !config.has_joint_limit_avoidance)
    throw std::invalid_argument("a posture needs joint-limit avoidance");
  if (config.q_posture)
    posture_.emplace(*config.q_posture, config.limits.max_velocity, inv_sqrt_weights_);
  if (std::ranges::any_of(config.tactile_modules,
                          [](const auto& m) { return m.cover.has_value(); }))
    for (const TactileModuleConfig& module : config.tactile_modules)
      covers_.emplace_back(config, module);
  if (!config.force_control) return;
  const std::size_t modules = config.tactile_modules.size();
  if (modules == 0 || (modules > 1 && config.force_control->variant != Variant::kNullLimit))
    throw std::invalid_argument(
        "force control needs a tactile module, null_limit alone takes more");
  if (hasContactRows(config)) {
    several_contacts_.emplace(config, inv_sqrt_weights_);
  } else {
    contact_controller_.emplace(config, inv_sqrt_weights_);
  }
}

ControllerState Controller::initialState(const JointVector& q) const {
  ControllerState state;
  place(q, config_.gains, state);
  for (int i = 0; i < modules(); ++i)
    state.modules[i].contact.position_m = 0.5 * config_.tactile_modules[i].length_m;
  if (contact_controller_) state.contact = contact_controller_->initialState();
  if (several_contacts_) state.several = several_contacts_->initialState();
  if (config_.task.commands) state.tool_motion.emplace(tipPose(config_.chain, q));
  return state;
}

void Controller::update(const RobotInput& input, const Gains& gains, double t_s, double period_s,
                        ControllerState& state, ControllerOutput& output) const noexcept {
  PreparedCycle prepared;
  output.path_time_s = t_s - state.waited_s;
  computeMotion(gains, output.path_time_s, state, prepared);
  respond(input, gains, period_s, prepared, state, output);
}

void Controller::prepare(const Gains& gains, double t_s, ControllerState& state,
                         PreparedCycle& prepared) const noexcept {
  prepared.path_time_s = t_s - state.waited_s;
  prepared.q_desired = state.q_desired;
  prepared.push = state.contact.push;
  prepared.return_share = state.return_share;
  prepared.is_leaning = state.is_leaning;
  prepared.task_gains = gains.task;
  prepared.limit_gains = gains.joint_limit_avoidance;
  if (posture_) prepared.posture_gains = gains.posture;
  computeMotion(gains, prepared.path_time_s, state, prepared);
}

void Controller::update(const RobotInput& input, const Gains& gains, double t_s, double period_s,
                        PreparedCycle& prepared, ControllerState& state,
                        ControllerOutput& output) const noexcept {
  output.path_time_s = t_s - state.waited_s;
  if (prepared.path_time_s != output.path_time_s || prepared.q_desired != state.q_desired ||
      prepared.push != state.contact.push || prepared.return_share != state.return_share ||
      prepared.is_leaning != state.is_leaning || !isSame(prepared.task_gains, gains.task) ||
      !isSame(prepared.limit_gains, gains.joint_limit_avoidance) ||
      (posture_ && !isSame(prepared.posture_gains, gains.posture)))
    computeMotion(gains, output.path_time_s, state, prepared);
  prepared.path_time_s = std::numeric_limits<double>::quiet_NaN();
  respond(input, gains, period_s, prepared, state, output);
}

void Controller::computeMotion(const Gains& gains, double path_time_s, ControllerState& state,
                               PreparedCycle& prepared) const noexcept {
  computeKinematics(path_time_s, state, prepared);
  computeTaskMotion(gains.task, state, prepared);
  Motion& motion = prepared.motion;
  motion.y = prepared.kinematics.y_eff;
  if (joint_limit_avoidance_) {
    lower(costAt(state.q_desired, gains, state), prepared.kinematics, state, motion);
  } else {
    motion.v_scaled.setZero();
  }
  if (gate_.clearance()) lookAround(state, prepared);
}

void Controller::respond(const RobotInput& input, const Gains& gains, double period_s,
                         PreparedCycle& prepared, ControllerState& state,
                         ControllerOutput& output) const noexcept {
  sense(input, gains, period_s, prepared, state, output);
  const TaskKinematics& kinematics = prepared.kinematics;
  Motion& motion = prepared.motion;
  const int task_size = config_.task.size;
  assign(prepared.w, task_size, output.w);
  assign(prepared.w + kinematics.error, task_size, output.w_d);
  if (has_rotation_) replaceRotation(config_.task, prepared.rotation_vector_d, output.w_d);
  assign(prepared.w_d_dot, task_size, output.w_d_dot);
  assign(kinematics.error, task_size, output.error);
  state.progress = prepared.progress;
  output.contact = {};
  FreeAcceleration free;
  if (is_acceleration_level_)
    free = freeAcceleration(gains, output.path_time_s, period_s, prepared, state);
  if (config_.force_control)
    answerContact(gains, kinematics, free, period_s, state, output, motion);
  const bool keeps_rows =
      config_.force_control && config_.force_control->variant == Variant::kNullLimit;
  if (gate_.clearance() && !keeps_rows)
    state.contact.cut_by_rows_m_per_s =
        state.mayMove() ? keepClear(kinematics, period_s, state, motion) : 0.0;

  motion.v_scaled += kinematics.pseudoinverse.expand(motion.y);
  motion.v_scaled.array() *= inv_sqrt_weights_.array();
  output.velocity = motion.v_scaled.head(config_.chain.size());
  if (!state.mayMove()) {
    output.velocity.setZero();
    if (state.retreat.is_under_way)
      leaveContact(gains, kinematics, period_s, state, output.velocity);
  }
  limit(prepared, period_s, state, output);
}

void Controller::answerContact(const Gains& gains, const TaskKinematics& kinematics,
                               const FreeAcceleration& free, double period_s,
                               ControllerState& state, ControllerOutput& output,
                               Motion& motion) const noexcept {
  const CommandedMotion commanded{state.q_desired, state.velocity_before, state.mayMove(),
                                  state.return_share, &free};
  if (several_contacts_) {
    several_contacts_->update(gains, kinematics, state.modules, commanded, gate_, period_s,
                              state.several, output.contact, motion);
  } else {
    contact_controller_->update(gains, kinematics, state.modules.front().contact, commanded, gate_,
                                period_s, state.contact, output.contact, motion);
  }
}

void Controller::coast(int missed_cycles, double period_s, ControllerState& state) const noexcept {
  passTime(missed_cycles * period_s, state);
  if (config_.module_loss)  // faster only cycle by cycle
    state.speed_share =
        std::min(state.speed_share, speedShareAfter(missed_cycles * period_s, state));
  if (state.is_stopping && !state.retreat.is_under_way)
    rampOn(config_.limits, missed_cycles * period_s, state.velocity_before);
  for (int i = 0; i < modules(); ++i) {
    state.modules[i].age_s += missed_cycles * period_s;
    state.modules[i].cover.missed_s += missed_cycles * period_s;
  }
}

void Controller::passTime(double duration_s, ControllerState& state) const noexcept {
  for (int i = 0; i < config_.chain.size(); ++i) {
    const double q = state.q_desired[i] + duration_s * state.velocity_before[i];
    state.q_desired[i] = std::clamp(q, config_.limits.lower[i], config_.limits.upper[i]);
  }
  // Else the task's clock, of which waited_s is taken, stands still itself.
  if (state.is_stopping) {
    if (state.retreat.is_under_way) goAway(state.velocity_before, duration_s, state.retreat);
    return;
  }
  state.waited_s += (1.0 - state.progress) * duration_s;
  state.return_share = std::min(1.0, state.return_share + duration_s / kReturnRise_s);
}

JointLimitCost Controller::costAt(const JointVector& q, const Gains& gains,
                                  ControllerState& state) const noexcept {
  JointLimitCost cost =
      joint_limit_avoidance_->evaluate(gains.joint_limit_avoidance, q, state.zones);
  if (posture_) posture_->addTo(cost.gradient, gains.posture, q);
  return cost;
}

ToolAcceleration Controller::referenceAcceleration(double path_time_s,
                                                   const ControllerState& state) const noexcept {
  return state.tool_motion ? state.tool_motion->evaluateAcceleration(path_time_s)
                           : trajectory_.evaluateAcceleration(path_time_s);
}

ToolReference Controller::referenceAt(double path_time_s,
                                      const ControllerState& state) const noexcept {
  return state.tool_motion ? state.tool_motion->evaluate(path_time_s)
                           : trajectory_.evaluate(path_time_s);
}

void Controller::computeKinematics(double path_time_s, const ControllerState& state,
                                   PreparedCycle& prepared) const noexcept {
  const TaskConfig& task = config_.task;
  TaskKinematics& kinematics = prepared.kinematics;
  config_.chain.computePose(state.q_desired, kinematics.pose);
  const ToolReference reference = referenceAt(path_time_s, state);
  Twist w, w_d_dot, error;  // their rotation only where the task has one
  w.head<3>() = framePosition(kinematics.pose, config_.chain.tip());
  error.head<3>() = reference.p_BaseTool - w.head<3>();
  w_d_dot << reference.v_BaseTool, reference.omega_BaseTool;
  ScaledJacobian J;
  computeTipJacobian(config_.chain, kinematics.pose, w.head<3>(), task.components.data(), task.size,
                     inv_sqrt_weights_, J);
  if (has_rotation_) {
    const Matrix3 R_BaseTool = framePose(kinematics.pose, config_.chain.tip()).R_AB;
    w.tail<3>() = rotationVector(R_BaseTool);
    error.tail<3>() = rotationVector(reference.R_BaseTool * R_BaseTool.transpose());
    prepared.rotation_vector_d = rotationVector(reference.R_BaseTool);
    if (has_part_of_rotation_)
      w_d_dot.tail<3>() =
          keepPartOfRotation(kinematics.pose, error.tail<3>(), reference.omega_BaseTool, J);
  }
  kinematics.pseudoinverse.factorise(J, config_.chain.size(), task.size);
  kinematics.error.setZero();
  prepared.w.setZero();
  prepared.w_d_dot.setZero();
  for (int i = 0; i < task.size; ++i) {
    const int component = task.components[i];
    kinematics.error[i] = error[component];
    prepared.w[i] = w[component];
    prepared.w_d_dot[i] = w_d_dot[component];
  }
}

void Controller::computeTaskMotion(const TaskGains& gains, const ControllerState& state,
                                   PreparedCycle& prepared) const noexcept {
  TaskKinematics& kinematics = prepared.kinematics;
  prepared.progress = 1.0;
  if (std::min(gains.wait_beyond_m, gains.wait_beyond_rad) < kNoLimit) {
    prepared.progress = pathProgress(gains, toolLag(config_.task, kinematics.error));
    prepared.w_d_dot *= prepared.progress;
  }
  PaddedTaskVector correction = state.return_share * gains.drift_gain_per_s * kinematics.error;
  if (hasReturnSpeed(gains)) {
    TaskVector limited = correction.head(config_.task.size);
    limitReturnSpeed(gains, config_.task, state.contact.push, limited);
    correction = paddedTask(limited);
  }
  kinematics.y_eff =
      kinematics.pseudoinverse.solve(PaddedTaskVector(prepared.w_d_dot + correction));
}

}  // namespace tactus
