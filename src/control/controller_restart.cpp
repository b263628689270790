#include <algorithm>

#include "tactus/control/controller.h"
#include "tactus/control/return_speed.h"

/// How an arm goes on that its drives had stopped by themselves.
namespace tactus {
namespace {

/// m or rad; less is an encoder's rounding, and no jump.
constexpr double kBeside = 1e-4;

}  // namespace

void Controller::restart(const Gains& gains, ControllerState& state) const noexcept {
  if (joint_limit_avoidance_ && state.return_share > 0.0) {  // else it has not moved since
    state.way_out_before =
        -joint_limit_avoidance_->evaluate(gains.joint_limit_avoidance, state.q_desired, state.zones)
             .gradient;
    softenWayOut(state.return_share, ScaledVector::Zero(), state.way_out_added,
                 state.way_out_before);
  }
  state.return_share = 0.0;
  for (TactileReading& reading : state.modules) reading.cover.has_started = false;
  if (contact_controller_) state.contact = contact_controller_->initialState();
  state.contact.is_resting = true;  // so that it goes on by what it feels then
  if (several_contacts_) state.several = several_contacts_->initialState();
}

void Controller::place(const JointVector& q, const Gains& gains,
                       ControllerState& state) const noexcept {
  state.q_desired = q.cwiseMax(config_.limits.lower).cwiseMin(config_.limits.upper);
  state.velocity_before = JointVector::Zero(config_.chain.size());
  state.fault = Fault::kNone;
  state.retreat.velocity_at_fault = state.velocity_before;
  if (!joint_limit_avoidance_) return;
  const auto isPushed = [&](const TactileReading& reading) {
    return reading.contact.force_N > gains.force.transition.release_force_N;
  };
  leadAnew(gains, config_.force_control && std::ranges::any_of(state.modules, isPushed), state);
}

/// What of the null space's motion comes back gently: all, or where the arm leans on something
/// what it had not before.
void Controller::leadAnew(const Gains& gains, bool is_leaning,
                          ControllerState& state) const noexcept {
  state.is_leaning = is_leaning;
  state.way_out_added = -costAt(state.q_desired, gains, state).gradient;
  if (is_leaning) state.way_out_added -= state.way_out_before;
}

void Controller::begin(ControllerState& state) const noexcept {
  const JointVector beside = state.q_desired - config_.q_start;
  // A scene may begin far from its posture, and where it begins.
  if (posture_ || beside.cwiseAbs().maxCoeff() > kBeside) state.return_share = 0.0;
}

void Controller::goOn(const Gains& gains, ControllerState& state) const noexcept {
  state.retreat.is_under_way = false;
  if (state.retreat.has_moved) {
    state.retreat.has_moved = false;
    restart(gains, state);
    place(JointVector(state.q_desired), gains, state);
  } else if (posture_ && state.return_share > 0.0) {  // else it only begins
    // A hold has changed nothing for the law, but the posture may lead on by a jump.
    state.return_share = 0.0;
    leadAnew(gains, false, state);
  }
}

}  // namespace tactus
