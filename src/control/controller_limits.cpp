#include <algorithm>
#include <cmath>

#include "tactus/control/controller.h"

/// The last gate before the drives.
namespace tactus {
namespace {

/// a^T (from - to); an array's dot product, without the choice of a way that costs as much.
double lostRetreat(const ScaledVector& a, const JointVector& from, const JointVector& to) noexcept {
  double sum = 0.0;
  const auto joints = static_cast<int>(from.size());
  for (int i = 0; i < joints; ++i) sum += a.data()[i] * (from.data()[i] - to.data()[i]);
  return sum;
}

}  // namespace

void Controller::limit(const PreparedCycle& prepared, double period_s, ControllerState& state,
                       ControllerOutput& output) const noexcept {
  state.contact.cut_m_per_s = 0.0;
  if (output.speed_share < 1.0 || !admits(prepared, period_s, state, output.velocity))
    cut(prepared, period_s, state, output);
  output.fault = state.fault;
  assign(state.q_desired, output.q_desired);
  assign(output.velocity, state.velocity_before);
  passTime(period_s, state);
}

bool Controller::admits(const PreparedCycle& prepared, double period_s,
                        const ControllerState& state, const JointVector& velocity) const noexcept {
  return limiter_.admits(state.q_desired, state.velocity_before, period_s, velocity) &&
         (!gate_.clearance() ||
          gate_.clearance()->canStopAfter(prepared.kinematics.pose, prepared.kinematics.near,
                                          state.q_desired, velocity, period_s));
}

/// What the limits cut from the contact point's motion is told to the law, which must not ask for
/// more and more of it.
void Controller::cut(const PreparedCycle& prepared, double period_s, ControllerState& state,
                     ControllerOutput& output) const noexcept {
  const Motion& motion = prepared.motion;
  const JointVector wanted = output.velocity;
  if (output.speed_share < 1.0 && state.mayMove()) boundSpeeds(output.speed_share, output.velocity);
  const bool finite =
      limiter_.apply(state.q_desired, state.velocity_before, period_s, output.velocity);
  if (gate_.clearance())
    gate_.clearance()->holdBack(prepared.kinematics.pose, prepared.kinematics.near, state.q_desired,
                                state.velocity_before, period_s, output.velocity);
  if (contact_controller_ && state.mayMove())
    state.contact.cut_m_per_s = std::max(0.0, lostRetreat(motion.a, wanted, output.velocity));
  if (finite) return;
  state.fault = Fault::kCommandNotFinite;
  output.fault_detail = notFinite(motion);
}

FaultDetail Controller::notFinite(const Motion& motion) const noexcept {
  for (int i = 0; i < config_.chain.size(); ++i) {
    if (std::isfinite(motion.v_scaled[i])) continue;
    const bool is_prismatic = config_.chain.type(i) == JointType::kPrismatic;
    return {motion.v_scaled[i], config_.limits.max_velocity[i], is_prismatic ? "m/s" : "rad/s", i};
  }
  return {};
}

}  // namespace tactus
