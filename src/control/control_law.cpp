#include "tactus/control/control_law.h"

#include <algorithm>
#include <cmath>

#include "tactus/math/filter.h"

namespace tactus {

namespace {

/// Adds a change to V or I as far as ControlLaw lets it.
void integrate(const ForceGains& gains, double change_m_per_s, const ControlLawInput& input,
               double period_s, double& integral_m_per_s) {
  if (input.cut_m_per_s > 0.0)
    change_m_per_s -= period_s / gains.time_constant_s * input.cut_m_per_s;
  if (!input.is_followed || input.cut_m_per_s > 0.0) change_m_per_s = std::min(change_m_per_s, 0.0);
  const double lowest = std::min(0.0, integral_m_per_s);
  integral_m_per_s = std::max(lowest, integral_m_per_s + change_m_per_s);
}

}  // namespace

double signedContactForce_N(const ForceGains& gains, double force_N) noexcept {
  const double missing_N = gains.contact_threshold_N - force_N;
  const double felt_N = force_N - gains.transition.release_force_N;
  return missing_N > 0.0 ? -std::max(0.0, std::min(missing_N, felt_N)) : -missing_N;
}

ControlLaw::ControlLaw(const ForceControlConfig& config, const SerialChain& chain,
                       const ScaledVector& inv_sqrt_weights)
    : variant_(config.variant),
      order_(config.order),
      has_null_space_(config.variant != Variant::kJointSpace &&
                      config.variant != Variant::kTaskSpace),
      has_second_space_(isOfTwoSpaces(config.variant)),
      null_speed_limit_(chain, inv_sqrt_weights) {}

double ControlLaw::proportionalGain(const ForceGains& gains,
                                    double stiffness_N_per_m) const noexcept {
  const double gain = order_ == 2 ? 2.0 * gains.damping : 1.0;
  return gain / (gains.time_constant_s * stiffness_N_per_m);
}

void ControlLaw::update(const ForceGains& gains, const ControlLawInput& input,
                        const ContactSpace& space, double period_s, ControlLawState& state,
                        ControlLawOutput& output) const noexcept {
  state.V_m_per_s = flushed(state.V_m_per_s * input.integral_decay);
  // x_ff - P F_p - V, and -max(0, P (F_p - F_act) + I), m/s.
  const double P = proportionalGain(gains, input.stiffness_N_per_m);
  const double single =
      input.x_dot_ff_m_per_s - P * input.F_p_N - input.integral_share * state.V_m_per_s;
  const double excess_N = input.F_p_N - gains.activation_force_N;
  const double second = -std::max(0.0, P * excess_N + state.It_m_per_s);
  bool limited = false;
  output = {};
  switch (variant_) {
    case Variant::kNone:
      return;
    case Variant::kJointSpace:
      output.u_j = single * invertRegularised(space.k_j, space.k_j);
      break;
    case Variant::kTaskSpace:
      output.u_t = single * invertRegularised(space.k_t, space.k_j);
      break;
    case Variant::kNullTask:
      output.u_t = second * invertRegularised(space.k_t, space.k_j);
      break;
    case Variant::kNullJoint:
      output.u_j = second * invertRegularised(space.k_j, space.k_j);
      break;
    case Variant::kNullSpace:
    case Variant::kNullLimit:
      break;
  }
  if (has_null_space_) {
    output.u_n = single * invertRegularised(space.k_n, space.k_j);
    const double share =
        null_speed_limit_.share(gains, output.u_n * space.a_scaled, state.null_speed);
    output.u_n *= share;
    limited = share < 1.0;
  }
  if (order_ == 1) return;
  const double rate =
      period_s / (gains.time_constant_s * gains.time_constant_s * input.stiffness_N_per_m);
  if (!limited && (!input.hold_integral || input.cut_m_per_s > 0.0))
    integrate(gains, rate * input.F_p_N, input, period_s, state.V_m_per_s);
  if (has_second_space_) integrate(gains, rate * excess_N, input, period_s, state.It_m_per_s);
}

}  // namespace tactus
