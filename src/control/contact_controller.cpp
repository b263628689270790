#include "tactus/control/contact_controller.h"

#include <algorithm>

#include "tactus/control/return_speed.h"
#include "tactus/math/filter.h"

namespace tactus {

/// A contact as the joints see it.
struct ContactController::Contact {
  Vector3 p_Base;
  JointVector a;  ///< J_p^T F^
  ContactSpace space;
};

ContactController::ContactController(const ControllerConfig& config,
                                     const ScaledVector& inv_sqrt_weights)
    : chain_(config.chain),
      link_(config.tactile_module->link),
      initial_position_m_(0.5 * config.tactile_module->length_m),
      task_(config.task),
      config_(*config.force_control),
      inv_sqrt_weights_(inv_sqrt_weights),
      law_(config_, config.chain, inv_sqrt_weights) {
  if (config_.variant == Variant::kJointSpace) {
    joint_space_transition_.emplace(config_);
  } else {
    transition_.emplace(config_.transition);
  }
  if (config_.variant == Variant::kNullLimit) {
    approach_limit_.emplace(config);
  } else if (config_.estimator) {
    estimator_.emplace(*config_.estimator);
  }
}

ContactControllerState ContactController::initialState() const {
  ContactControllerState state;
  state.joint_space_transition.contact.position_m = initial_position_m_;
  state.estimator = {config_.assumed_stiffness_N_per_m, config_.assumed_stiffness_N_per_m};
  if (approach_limit_) state.approach = approach_limit_->initialState();
  const bool is_multi_space =
      config_.variant == Variant::kNullTask || config_.variant == Variant::kNullJoint;
  if (is_multi_space && hasReturnSpeed(task_)) state.push = TaskVector::Zero(task_.size);
  return state;
}

void ContactController::update(const TaskKinematics& kinematics, const ContactPointState& sensor,
                               const CommandedMotion& commanded, double period_s,
                               ContactControllerState& state, ContactReport& report,
                               Motion& motion) const noexcept {
  const ContactPointState& point = follow(sensor, kinematics, commanded, period_s, state);
  const Contact contact = locate(kinematics, point);

  ControlLawInput input;
  input.F_p_N = std::max(0.0, point.force_N - config_.contact_threshold_N);
  if (approach_limit_) {
    approach_limit_->observe(contact.a, input.F_p_N, commanded.q, period_s, state.approach);
    input.stiffness_N_per_m = state.approach.estimator.stiffness_N_per_m;
    input.hold_integral = state.approach.is_limiting;
    report.stiffness_raw_N_per_m = state.approach.estimator.stiffness_raw_N_per_m;
  } else {
    if (estimator_) {
      const double approach_m_per_s = -contact.a.dot(commanded.velocity);  // (15)
      estimator_->update(input.F_p_N, approach_m_per_s, period_s, state.estimator);
    }
    input.stiffness_N_per_m = state.estimator.stiffness_N_per_m;
    report.stiffness_raw_N_per_m = state.estimator.stiffness_raw_N_per_m;
  }
  if (state.is_resting && commanded.is_followed) goOn(contact, point, state);
  state.is_resting = !commanded.is_followed;
  if (!commanded.is_followed) {
    rest(contact, period_s, state, report, input);
  } else if (joint_space_transition_) {
    passJointSpaceTransition(kinematics, contact, commanded.return_share, period_s, state, report,
                             input, motion);
  } else {
    passTransition(contact, period_s, state, report, input);
  }
  input.is_followed = commanded.is_followed;
  input.cut_m_per_s = state.cut_m_per_s;
  ControlLawOutput u;
  law_.update(input, contact.space, period_s, state.law, u);
  if (approach_limit_) {
    const ContactSpace& space = contact.space;
    const double v_res =
        space.a_task.dot(motion.y) + space.a_scaled.dot(motion.v_scaled) - space.k_n * u.u_n;
    u.u_t = approach_limit_->excess(input.F_p_N, v_res, state.approach) *
            invertRegularised(space.k_t, space.k_j);
  }

  // J# J b u_t = W^-1/2 Q (Q^T a^) u_t needs no inverse, so it is exact in singular poses, too.
  motion.y += (u.u_n - u.u_t) * contact.space.a_task;
  motion.v_scaled -= (u.u_n + u.u_j) * contact.space.a_scaled;
  motion.a = contact.a;

  if (state.push.size() > 0)
    state.push = kinematics.pseudoinverse.taskVelocity(-(u.u_t + u.u_j) * contact.space.a_task);
  if (!commanded.is_followed) state.push.setZero();

  report.force_contact_N = input.F_p_N;
  report.stiffness_N_per_m = input.stiffness_N_per_m;
  report.k_n = contact.space.k_n;
  report.k_j = contact.space.k_j;
  report.k_t = contact.space.k_t;
  report.u_n = u.u_n;
  report.u_j = u.u_j;
  report.u_t = u.u_t;
}

const ContactPointState& ContactController::follow(const ContactPointState& sensor,
                                                   const TaskKinematics& kinematics,
                                                   const CommandedMotion& commanded,
                                                   double period_s,
                                                   ContactControllerState& state) const noexcept {
  if (joint_space_transition_) {
    joint_space_transition_->follow(sensor, commanded.is_followed, period_s,
                                    state.joint_space_transition);
    return state.joint_space_transition.contact;
  }
  if (approach_limit_) {
    ContactPointState& contact = state.approach.smoother.contact;
    contact.interval_s = 0.0;
    if (sensor.isNew())
      approach_limit_->follow(sensor, framePose(kinematics.pose, link_), state.approach);
    return contact;
  }
  return hasReturnSpeed(task_) ? holdLost(sensor, state) : sensor;
}

/// Below the threshold the reading of a contact that is gone turns with the ringing of the sensor's
/// filter. What is left of the law's answer would turn with it and push the tool on top of its
/// return.
const ContactPointState& ContactController::holdLost(const ContactPointState& sensor,
                                                     ContactControllerState& state) const noexcept {
  ContactPointState& contact = state.contact;
  if (sensor.force_N > config_.contact_threshold_N || !state.transition.touched) {
    contact = sensor;
  } else {
    contact.force_N = sensor.force_N;
    contact.interval_s = sensor.interval_s;
  }
  return contact;
}

ContactController::Contact ContactController::locate(
    const TaskKinematics& kinematics, const ContactPointState& point) const noexcept {
  Contact contact;
  const Pose& X_JointModule = link_.X_JointFrame;
  const Vector3 p_JointContact = X_JointModule.p_AB + point.position_m * X_JointModule.R_AB.col(0);
  const Vector3 F_Joint = X_JointModule.R_AB.lazyProduct(point.direction);
  contact.p_Base = pointInBase(kinematics.pose, link_.joint, p_JointContact);
  const Vector3 F_Base = vectorInBase(kinematics.pose, link_.joint, F_Joint);
  applyPointJacobianTranspose(chain_, kinematics.pose, link_.joint, contact.p_Base, F_Base,
                              contact.a);
  computeContactSpace(kinematics.pseudoinverse, contact.a, inv_sqrt_weights_, kinematics.y_eff,
                      contact.space);
  return contact;
}

/// What the arm feels while it does not move says nothing of how it goes on: only the integral
/// fades where nothing is felt.
void ContactController::rest(const Contact& contact, double period_s, ContactControllerState& state,
                             ContactReport& report, ControlLawInput& input) const noexcept {
  const double fade = lagShare(period_s, config_.transition.max_time_constant_s);
  input.integral_decay = input.F_p_N > 0.0 ? 1.0 : 1.0 - fade;
  if (joint_space_transition_) joint_space_transition_->rest(state.joint_space_transition);
  report.gamma =
      joint_space_transition_ ? state.joint_space_transition.gamma : state.transition.gamma;
  report.x_dot_eff_m_per_s = contact.space.x_dot_eff_m_per_s;
}

/// By what the sensor says now: an arm that leans on something is in contact, even below F_th; any
/// other has never touched.
void ContactController::goOn(const Contact& contact, const ContactPointState& point,
                             ContactControllerState& state) const noexcept {
  const bool is_touching = point.force_N > config_.transition.release_force_N;
  const double gamma = is_touching ? 1.0 : 0.0;
  state.transition = {is_touching, contact.p_Base, gamma};
  state.joint_space_transition.touching = is_touching;
  state.joint_space_transition.gamma = gamma;
  state.joint_space_transition.p_BaseLost = contact.p_Base;
}

void ContactController::passTransition(const Contact& contact, double period_s,
                                       ContactControllerState& state, ContactReport& report,
                                       ControlLawInput& input) const noexcept {
  const double x_dot_eff = contact.space.x_dot_eff_m_per_s;
  input.integral_decay =
      transition_->update(input.F_p_N, contact.p_Base, period_s, state.transition);
  input.x_dot_ff_m_per_s = state.transition.gamma * std::min(x_dot_eff, 0.0);
  report.gamma = state.transition.gamma;
  report.x_dot_eff_m_per_s = x_dot_eff;
}

void ContactController::passJointSpaceTransition(const TaskKinematics& kinematics,
                                                 const Contact& contact, double return_share,
                                                 double period_s, ContactControllerState& state,
                                                 ContactReport& report, ControlLawInput& input,
                                                 Motion& motion) const noexcept {
  JointSpaceTransitionState& transition = state.joint_space_transition;
  const ContactSpace& space = contact.space;
  const double x_free = space.a_task.dot(motion.y) + space.a_scaled.dot(motion.v_scaled);
  TaskVector y_pull = kinematics.pseudoinverse.solve(pull(kinematics.error));
  y_pull *= law_.speedShare(kinematics.pseudoinverse.expand(y_pull)) *
            (1.0 - motion.limit_nearness * motion.limit_nearness) * return_share;
  const double x_pull = space.a_task.dot(y_pull);
  const IntegralShare integral =
      joint_space_transition_->update({input.F_p_N, contact.p_Base, x_free}, period_s, transition);
  input.integral_decay = integral.decay;
  input.integral_share = integral.share;
  input.x_dot_ff_m_per_s = std::min(0.0, transition.gamma * x_free + transition.kappa * x_pull);
  motion.y += transition.kappa * y_pull;
  report.gamma = transition.gamma;
  report.x_dot_eff_m_per_s = x_free + transition.kappa * x_pull;
}

TaskVector ContactController::pull(const TaskVector& error) const noexcept {
  const TaskVector pull = config_.pull_gain_per_s * error;
  if (!hasReturnSpeed(task_)) return pull;
  TaskVector correction = task_.drift_gain_per_s * error;
  TaskVector both = correction + pull;
  limitReturnSpeed(task_, {}, correction);
  limitReturnSpeed(task_, {}, both);
  return both - correction;
}

}  // namespace tactus
