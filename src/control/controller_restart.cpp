#include <algorithm>

#include "tactus/control/controller.h"
#include "tactus/control/return_speed.h"

/// How an arm goes on that its drives had stopped by themselves.
namespace tactus {
namespace {

/// m or rad; less is an encoder's rounding, and no jump.
constexpr double kBeside = 1e-4;
/// m/s or rad/s, of a way out in scaled joints; less is no jump either.
constexpr double kLed = 1e-3;

Variant variantOf(const ControllerConfig& config) {
  return config.force_control ? config.force_control->variant : Variant::kNone;
}

/// Whether the law remembers a push that the way back to the task balances.
bool opposesTask(Variant variant) {
  return variant == Variant::kTaskSpace || variant == Variant::kJointSpace ||
         isOfTwoSpaces(variant);
}

}  // namespace

void Controller::restart(const Gains& gains, ControllerState& state) const noexcept {
  if (joint_limit_avoidance_ && state.return_share > 0.0)  // else it has not moved since
    state.way_out_before = state.retreat.has_moved ? state.retreat.way_out : wayOut(gains, state);
  state.return_share = 0.0;
  state.retreat.has_moved = false;
  for (TactileReading& reading : state.modules) reading.cover.has_started = false;
  if (contact_controller_) state.contact = contact_controller_->initialState();
  state.contact.is_resting = true;  // so that it goes on by what it feels then
  if (several_contacts_) state.several = several_contacts_->initialState();
}

/// Of joint limits alone: a posture holds no push off.
ScaledVector Controller::wayOut(const Gains& gains, ControllerState& state) const noexcept {
  ScaledVector way_out =
      -joint_limit_avoidance_->evaluate(gains.joint_limit_avoidance, state.q_desired, state.zones)
           .gradient;
  softenWayOut(state.return_share, ScaledVector::Zero(), state.way_out_added, way_out);
  return way_out;
}

void Controller::place(const JointVector& q, const Gains& gains,
                       ControllerState& state) const noexcept {
  state.q_desired = q.cwiseMax(config_.limits.lower).cwiseMin(config_.limits.upper);
  state.velocity_before = JointVector::Zero(config_.chain.size());
  state.fault = Fault::kNone;
  state.retreat.velocity_at_fault = state.velocity_before;
  if (joint_limit_avoidance_) leadAnew(gains, leans(gains, state), state);
}

bool Controller::leans(const Gains& gains, const ControllerState& state) const noexcept {
  const auto isPushed = [&](const TactileReading& reading) {
    return reading.contact.force_N > gains.force.transition.release_force_N;
  };
  return config_.force_control && std::ranges::any_of(state.modules, isPushed);
}

/// What of the null space's motion comes back gently: all, or where the arm leans on something
/// what it had not before.
void Controller::leadAnew(const Gains& gains, bool is_leaning,
                          ControllerState& state) const noexcept {
  state.is_leaning = is_leaning;
  state.way_out_added = -costAt(state.q_desired, gains, state).gradient;
  if (is_leaning) state.way_out_added -= state.way_out_before;
}

/// By this way out in its null space: one that only the task keeps from its limits is not.
bool Controller::isLed(const ScaledVector& way_out, const ControllerState& state) const noexcept {
  if (way_out.isZero(0.0)) return false;
  PreparedCycle prepared;
  computeKinematics(0.0, state, prepared);
  const WeightedPseudoinverse& pseudoinverse = prepared.kinematics.pseudoinverse;
  const ScaledVector motion = way_out - pseudoinverse.expand(pseudoinverse.project(way_out));
  return motion.cwiseAbs().maxCoeff() > kLed;
}

/// The way out of limits' zones, where it leads the arm: as soon as what an arm leans on asks for,
/// for it may be what keeps a joint off its limit against the motion of the path.
void Controller::bringBackSoon(const ScaledVector& way_out, ControllerState& state) const noexcept {
  if (!isLed(way_out, state)) return;
  state.return_share = 0.0;
  state.is_leaning = true;
  state.way_out_before = way_out;
  state.way_out_added.setZero();
}

/// By costs that hold nothing off.
bool Controller::isLedAway() const noexcept {
  return posture_ || (config_.clearance && config_.clearance->avoid);
}

void Controller::begin(ControllerState& state) const noexcept {
  const JointVector beside = state.q_desired - config_.q_start;
  // A scene may begin far from its posture, near to a joint limit or a body, and where it begins.
  if (isLedAway() || beside.cwiseAbs().maxCoeff() > kBeside) {
    state.return_share = 0.0;
  } else {
    bringBackSoon(ScaledVector(state.way_out_added), state);
  }
}

void Controller::hold(const Gains& gains, ControllerState& state) const noexcept {
  state.has_leaned = leans(gains, state);
}

void Controller::goOn(const Gains& gains, ControllerState& state) const noexcept {
  state.retreat.is_under_way = false;
  // The reference of a task by commands is put where the tool is: nothing balances its push.
  const bool loses_balance = state.tool_motion && opposesTask(variantOf(config_));
  if (state.retreat.has_moved || (loses_balance && state.return_share > 0.0)) {
    restart(gains, state);
    place(JointVector(state.q_desired), gains, state);
    return;
  }
  // A law that holds a push off goes on in the balance that it had. But costs lead an arm that is
  // free, or was, on by a jump, and without its pull (joint_space_transition.h) joint space is out
  // of balance.
  const bool keeps_balance = state.has_leaned && leans(gains, state);
  const bool is_led_away =
      variantOf(config_) == Variant::kJointSpace || (isLedAway() && !keeps_balance);
  if (state.return_share == 0.0) return;
  if (is_led_away) {
    state.return_share = 0.0;
    if (joint_limit_avoidance_) leadAnew(gains, false, state);
  } else if (joint_limit_avoidance_ && !keeps_balance) {
    bringBackSoon(ScaledVector(-costAt(state.q_desired, gains, state).gradient), state);
  }
}

}  // namespace tactus
