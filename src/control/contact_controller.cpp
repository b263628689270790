#include "tactus/control/contact_controller.h"

#include <algorithm>

#include "tactus/control/return_speed.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// Below the threshold the reading of a contact that is gone turns with the ringing of the sensor's
/// filter. What is left of the law's answer would turn with it and push the tool on top of its
/// return.
const ContactPointState& holdLost(const ForceGains& gains, const ContactPointState& sensor,
                                  ContactControllerState& state) noexcept {
  ContactPointState& contact = state.contact;
  if (sensor.force_N > gains.contact_threshold_N || !state.transition.touched) contact = sensor;
  contact.force_N = sensor.force_N;
  return contact;
}

/// By what the sensor says now: an arm that leans on something is in contact, even below F_th; any
/// other has never touched.
void goOn(const Vector3& p_BaseContact, bool is_touching, ContactControllerState& state) noexcept {
  state.approach.rested_N_per_m = 0.0;
  const double gamma = is_touching ? 1.0 : 0.0;
  state.transition = {is_touching, p_BaseContact, gamma};
  state.joint_space_transition.touching = is_touching;
  state.joint_space_transition.gamma = gamma;
}

void rememberPush(bool pushes, const WeightedPseudoinverse& pseudoinverse,
                  const PaddedTaskVector& y_push, ContactControllerState& state) noexcept {
  if (pushes) {
    state.push = pseudoinverse.taskVelocity(y_push);
  } else {
    state.push.setZero();
  }
  state.has_push = pushes;
}

/// a^T q_dot
double speedAlong(const ContactSpace& space, const Motion& motion, int task_size) noexcept {
  return dot(space.a_task, motion.y, task_size) + dot(space.a_scaled, motion.v_scaled);
}

void tell(double F_p_N, const ControlLawInput& input, const ContactSpace& space,
          const ControlLawOutput& u, ContactReport& report) noexcept {
  report.force_contact_N = F_p_N;
  report.stiffness_N_per_m = input.stiffness_N_per_m;
  report.k_n = space.k_n;
  report.k_j = space.k_j;
  report.k_t = space.k_t;
  report.u_n = u.u_n;
  report.u_j = u.u_j;
  report.u_t = u.u_t;
}

}  // namespace

/// A contact as the joints see it.
struct ContactController::Contact {
  explicit Contact(const ScaledVector& a_of_motion) : a(a_of_motion) {}

  Vector3 p_Base, F_Base;  ///< the point, m, and F^
  const ScaledVector& a;   ///< J_p^T F^, in the motion
  ContactSpace space;
};

ContactController::ContactController(const ControllerConfig& config,
                                     const ScaledVector& inv_sqrt_weights)
    : chain_(config.chain),
      link_(config.tactile_modules.front().link),
      initial_position_m_(0.5 * config.tactile_modules.front().length_m),
      task_(config.task),
      is_joint_space_(config.force_control->variant == Variant::kJointSpace),
      is_multi_space_(isOfTwoSpaces(config.force_control->variant)),
      has_estimator_(config.force_control->has_estimator),
      inv_sqrt_weights_(inv_sqrt_weights),
      law_(*config.force_control, config.chain, inv_sqrt_weights) {
  if (config.force_control->level == ControlLevel::kAcceleration)
    acceleration_law_.emplace(*config.force_control);
  if (config.force_control->variant != Variant::kNullLimit) return;
  approach_limit_.emplace(config, config.tactile_modules.front());
  if (config.force_control->friction_coefficient <= 0.0) return;
  friction_cone_.emplace(config.tactile_modules.front(),
                         config.force_control->friction_coefficient);
}

ContactControllerState ContactController::initialState() const {
  ContactControllerState state;
  state.joint_space_transition.contact.position_m = initial_position_m_;
  if (approach_limit_) state.approach = approach_limit_->initialState();
  if (is_multi_space_) state.push = TaskVector::Zero(task_.size);
  return state;
}

void ContactController::update(const Gains& gains, const TaskKinematics& kinematics,
                               const ContactPointState& sensor, const CommandedMotion& commanded,
                               const MotionGate& gate, double period_s,
                               ContactControllerState& state, ContactReport& report,
                               Motion& motion) const noexcept {
  const ContactPointState& point = follow(gains, sensor, kinematics, commanded, period_s, state);
  const Contact contact = locate(kinematics, point, motion.a);

  const double F_p_N = std::max(0.0, point.force_N - gains.force.contact_threshold_N);
  ControlLawInput input{.F_p_N = F_p_N};
  estimate(gains.force, contact, commanded, period_s, state, report, input);
  if (state.is_resting && commanded.is_followed)
    goOn(contact.p_Base, point.force_N > gains.force.transition.release_force_N, state);
  state.is_resting = !commanded.is_followed;
  if (!commanded.is_followed) {
    rest(gains.force, contact, commanded.isAtRest(), period_s, state, report, input);
  } else if (is_joint_space_) {
    passJointSpaceContact(gains, kinematics, contact, commanded.return_share, period_s, state,
                          report, input, motion);
  } else {
    passContact(gains.force, contact, period_s, state, report, input);
  }
  input.is_followed = commanded.is_followed;
  input.cut_m_per_s = state.cut_m_per_s + state.cut_by_rows_m_per_s;
  const ContactSpace& space = contact.space;
  ControlLawOutput u;
  if (acceleration_law_)
    u = accelerate(gains.force, kinematics, contact.p_Base, contact.F_Base, space, commanded, input,
                   period_s, state.law, motion);
  else
    law_.update(gains.force, input, space, period_s, state.law, u);
  const bool has_rows = approach_limit_ && (friction_cone_ || gate.clearance());
  if (approach_limit_ && !has_rows) {
    const double v_res = speedAlong(space, motion, task_.size) - space.k_n * u.u_n;
    double excess = approach_limit_->excess(gains.force, F_p_N, v_res, state.approach);
    if (acceleration_law_ && excess < 0.0)
      excess =
          std::min(0.0, v_res - eased(gains.force, space, commanded, period_s, v_res - excess));
    u.u_t = excess * invertRegularised(space.k_t, space.k_j);
  }
  // J# J b u_t = W^-1/2 Q (Q^T a^) u_t needs no inverse, so it is exact in singular poses, too.
  motion.y += (u.u_n - u.u_t) * space.a_task;
  motion.v_scaled -= (u.u_n + u.u_j) * space.a_scaled;
  if (has_rows) state.approach.is_limiting = false;
  if (has_rows || (approach_limit_ && (state.cut_m_per_s > 0.0 || state.keeps_joints)))
    u.u_t +=
        limitRows(gains.force, kinematics, commanded, space, F_p_N, gate, period_s, state, motion);

  if (is_multi_space_ && (state.has_push || hasReturnSpeed(gains.task)))
    rememberPush(commanded.is_followed && hasReturnSpeed(gains.task), kinematics.pseudoinverse,
                 -(u.u_t + u.u_j) * space.a_task, state);
  tell(F_p_N, input, space, u, report);
}

void ContactController::estimate(const ForceGains& gains, const Contact& contact,
                                 const CommandedMotion& commanded, double period_s,
                                 ContactControllerState& state, ContactReport& report,
                                 ControlLawInput& input) const noexcept {
  if (approach_limit_) {
    const bool is_felt = state.approach.smoother.contact.force_N > gains.transition.release_force_N;
    const double nearness = is_felt ? state.transition.gamma : 0.0;
    approach_limit_->observe(gains, contact.a, {input.F_p_N, nearness}, commanded.q, period_s,
                             state.approach);
    input.stiffness_N_per_m = state.approach.estimator.stiffness_N_per_m;
    input.hold_integral = state.approach.is_limiting;
    report.stiffness_raw_N_per_m = state.approach.estimator.stiffness_raw_N_per_m;
    return;
  }
  const double c_0 = gains.assumed_stiffness_N_per_m;
  if (!has_estimator_ || state.estimator.stiffness_N_per_m == 0.0)
    state.estimator.stiffness_N_per_m = state.estimator.stiffness_raw_N_per_m = c_0;
  if (has_estimator_) {
    const double approach_m_per_s =
        -contact.a.head(commanded.velocity.size()).dot(commanded.velocity);  // (15)
    estimateStiffness(gains.estimator, input.F_p_N, approach_m_per_s, period_s, state.estimator);
  }
  input.stiffness_N_per_m = state.estimator.stiffness_N_per_m;
  report.stiffness_raw_N_per_m = state.estimator.stiffness_raw_N_per_m;
}

const ContactPointState& ContactController::follow(const Gains& gains,
                                                   const ContactPointState& sensor,
                                                   const TaskKinematics& kinematics,
                                                   const CommandedMotion& commanded,
                                                   double period_s,
                                                   ContactControllerState& state) const noexcept {
  if (is_joint_space_) {
    followContact(gains.force, sensor, commanded.is_followed, period_s,
                  state.joint_space_transition);
    return state.joint_space_transition.contact;
  }
  if (approach_limit_) {
    ContactPointState& contact = state.approach.smoother.contact;
    contact.interval_s = 0.0;
    if (sensor.isNew()) {
      approach_limit_->follow(gains.force, sensor, framePose(kinematics.pose, link_),
                              state.approach);
    }
    return contact;
  }
  if (hasReturnSpeed(gains.task)) return holdLost(gains.force, sensor, state);
  state.contact = sensor;  // for a cycle that is tuned to have one
  return sensor;
}

ContactController::Contact ContactController::locate(const TaskKinematics& kinematics,
                                                     const ContactPointState& point,
                                                     ScaledVector& a) const noexcept {
  Contact contact(a);
  const PlacedContact at = placed(kinematics.pose, link_, point);
  contact.p_Base = at.p_Base;
  contact.F_Base = at.F_Base;
  applyPointJacobianTranspose(chain_, kinematics.pose, link_.joint, contact.p_Base, contact.F_Base,
                              a);
  computeContactSpace(kinematics.pseudoinverse, a, inv_sqrt_weights_, kinematics.y_eff,
                      contact.space);
  return contact;
}

/// What the arm feels while it does not move says nothing of how it goes on: only the integral
/// fades where nothing is felt.
void ContactController::rest(const ForceGains& gains, const Contact& contact, bool is_at_rest,
                             double period_s, ContactControllerState& state, ContactReport& report,
                             ControlLawInput& input) const noexcept {
  if (!is_at_rest) state.approach.rested_N_per_m = 0.0;
  if (is_at_rest && approach_limit_) approach_limit_->rest(gains, input.F_p_N, state.approach);
  const double fade = lagShare(period_s, gains.transition.max_time_constant_s);
  input.integral_decay = input.F_p_N > 0.0 ? 1.0 : 1.0 - fade;
  state.approach.obstacle.v_m_per_s = state.approach.obstacle.high_s = 0.0;
  if (is_joint_space_) restTransition(state.joint_space_transition);
  report.gamma = is_joint_space_ ? state.joint_space_transition.gamma : state.transition.gamma;
  report.x_dot_eff_m_per_s = contact.space.x_dot_eff_m_per_s;
}

void ContactController::passContact(const ForceGains& gains, const Contact& contact,
                                    double period_s, ContactControllerState& state,
                                    ContactReport& report, ControlLawInput& input) const noexcept {
  const double x_dot_eff = contact.space.x_dot_eff_m_per_s;
  input.integral_decay =
      passTransition(gains.transition, input.F_p_N, contact.p_Base, period_s, state.transition);
  input.x_dot_ff_m_per_s = state.transition.gamma * std::min(x_dot_eff, 0.0);
  report.gamma = state.transition.gamma;
  report.x_dot_eff_m_per_s = x_dot_eff;
  if (!approach_limit_ || !state.transition.touched) return;
  input.F_p_N = signedContactForce_N(gains, state.approach.smoother.contact.force_N);
  if (input.F_p_N >= 0.0) return;
  // An offset of the sensor may look like it: that must not move the arm on and on.
  input.F_p_N *= state.transition.gamma;
  input.integral_decay += state.transition.gamma * (1.0 - input.integral_decay);
}

void ContactController::passJointSpaceContact(const Gains& gains, const TaskKinematics& kinematics,
                                              const Contact& contact, double return_share,
                                              double period_s, ContactControllerState& state,
                                              ContactReport& report, ControlLawInput& input,
                                              Motion& motion) const noexcept {
  JointSpaceTransitionState& transition = state.joint_space_transition;
  const ContactSpace& space = contact.space;
  const double x_free = speedAlong(space, motion, task_.size);
  PaddedTaskVector y_pull = kinematics.pseudoinverse.solve(pull(gains, kinematics.error));
  y_pull *= law_.nullSpeedLimit().share(gains.force, kinematics.pseudoinverse.expand(y_pull),
                                        state.law.null_speed) *
            (1.0 - motion.limit_nearness * motion.limit_nearness) * return_share;
  const double x_pull = dot(space.a_task, y_pull, task_.size);
  const IntegralShare integral =
      passTransition(gains.force, {input.F_p_N, contact.p_Base, x_free}, period_s, transition);
  input.integral_decay = integral.decay;
  input.integral_share = integral.share;
  input.x_dot_ff_m_per_s = std::min(0.0, transition.gamma * x_free + transition.kappa * x_pull);
  motion.y += transition.kappa * y_pull;
  report.gamma = transition.gamma;
  report.x_dot_eff_m_per_s = x_free + transition.kappa * x_pull;
}

TaskVector ContactController::pull(const Gains& gains, const PaddedTaskVector& all) const noexcept {
  const TaskVector error = all.head(task_.size);
  const TaskVector pull = gains.force.pull_gain_per_s * error;
  if (!hasReturnSpeed(gains.task)) return pull;
  TaskVector correction = gains.task.drift_gain_per_s * error;
  TaskVector both = correction + pull;
  limitReturnSpeed(gains.task, task_, {}, correction);
  limitReturnSpeed(gains.task, task_, {}, both);
  return both - correction;
}

}  // namespace tactus
