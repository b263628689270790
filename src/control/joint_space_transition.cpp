#include "tactus/control/joint_space_transition.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kReleased = 1e-6;  ///< a smaller gamma is none

void engage(const ForceGains& gains, double F_p_N, double period_s,
            JointSpaceTransitionState& state) noexcept {
  if (gains.transition.engage_force_N == 0.0) {
    state.gamma = 1.0;
    return;
  }
  const double ratio = F_p_N / gains.transition.engage_force_N;
  state.gamma += lagShare(period_s * ratio * ratio, gains.time_constant_s) * (1.0 - state.gamma);
}

void release(const ForceGains& gains, const JointSpaceTransitionInput& input, double period_s,
             JointSpaceTransitionState& state) noexcept {
  const ContactTransitionGains& transition = gains.transition;
  const double delta_m = (input.p_BaseContact - state.p_BaseLost).norm();
  const double v_search = transition.search_speed_m_per_s;
  const double speed = std::max(std::abs(input.x_dot_free_m_per_s), v_search);
  const double goal =
      std::max(0.0, 1.0 - delta_m / transition.distance_m - (speed > 0.0 ? v_search / speed : 0.0));
  if (goal < state.gamma)
    state.gamma += state.response.of(period_s, gains.time_constant_s) * (goal - state.gamma);
  if (state.gamma < kReleased) state.gamma = 0.0;
}

}  // namespace

void followContact(const ForceGains& gains, const ContactPointState& sensor, bool is_moving,
                   double period_s, JointSpaceTransitionState& state) noexcept {
  ContactPointState& contact = state.contact;
  contact.force_N = sensor.force_N;
  if (sensor.force_N <= gains.transition.release_force_N) return;
  const bool is_smoothed = state.gamma > 0.0 && is_moving;
  const double share = is_smoothed ? state.response.of(period_s, gains.time_constant_s) : 1.0;
  contact.position_m += share * (sensor.position_m - contact.position_m);
  contact.direction += share * (sensor.direction - contact.direction);
  const double length = contact.direction.norm();
  if (length > 0.0) contact.direction /= length;
}

IntegralShare passTransition(const ForceGains& gains, const JointSpaceTransitionInput& input,
                             double period_s, JointSpaceTransitionState& state) noexcept {
  const ContactTransitionGains& transition = gains.transition;
  const double F_sen_N = state.contact.force_N;
  IntegralShare integral;
  if (input.F_p_N > 0.0) {
    state.touching = true;
    engage(gains, input.F_p_N, period_s, state);
  } else {
    integral.decay = 1.0 - state.fade.of(period_s, transition.max_time_constant_s);
    integral.share = std::clamp((F_sen_N - transition.release_force_N) /
                                    (gains.contact_threshold_N - transition.release_force_N),
                                0.0, 1.0);
    if (F_sen_N < transition.release_force_N) {
      state.touching = false;
      integral.decay = 0.0;
    }
  }
  if (state.touching) {
    state.p_BaseLost = input.p_BaseContact;
  } else if (state.gamma > 0.0) {
    release(gains, input, period_s, state);
  }
  const double goal = state.touching ? state.gamma : 0.0;
  constexpr double kRegained = 0.95;
  if (state.kappa >= kRegained * goal) state.has_rested = false;
  const bool is_quick = goal > state.kappa && !state.has_rested;
  const double share = is_quick ? state.response.of(period_s, gains.time_constant_s)
                                : state.fade.of(period_s, transition.max_time_constant_s);
  state.kappa = flushed(state.kappa + share * (goal - state.kappa));
  return integral;
}

void restTransition(JointSpaceTransitionState& state) noexcept {
  state.kappa = 0.0;
  state.has_rested = true;
}

}  // namespace tactus
