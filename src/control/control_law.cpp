#include "tactus/control/control_law.h"

#include <algorithm>
#include <cmath>

#include "tactus/math/filter.h"

namespace tactus {

ControlLaw::ControlLaw(const ForceControlConfig& config, const SerialChain& chain,
                       const ScaledVector& inv_sqrt_weights)
    : config_(config),
      has_null_space_(config.variant != Variant::kJointSpace &&
                      config.variant != Variant::kTaskSpace),
      has_second_space_(config.variant == Variant::kNullTask ||
                        config.variant == Variant::kNullJoint),
      inv_max_null_speed_(ScaledVector::Zero()) {
  for (int i = 0; i < chain.size(); ++i) {
    const double limit = chain.type(i) == JointType::kPrismatic ? config.max_null_speed_m_per_s
                                                                : config.max_null_speed_rad_per_s;
    inv_max_null_speed_[i] = inv_sqrt_weights[i] / limit;
  }
}

double ControlLaw::proportionalGain(double stiffness_N_per_m) const noexcept {
  const double gain = config_.order == 2 ? 2.0 * config_.damping : 1.0;
  return gain / (config_.time_constant_s * stiffness_N_per_m);
}

double ControlLaw::singleSpace(const ControlLawInput& input,
                               const ControlLawState& state) const noexcept {
  return input.x_dot_ff_m_per_s - proportionalGain(input.stiffness_N_per_m) * input.F_p_N -
         input.integral_share * state.V_m_per_s;
}

double ControlLaw::secondSpace(const ControlLawInput& input,
                               const ControlLawState& state) const noexcept {
  const double excess_N = input.F_p_N - config_.activation_force_N;
  const double answer = proportionalGain(input.stiffness_N_per_m) * excess_N + state.It_m_per_s;
  return -std::max(0.0, answer);
}

double ControlLaw::speedShare(const ScaledVector& v_scaled) const noexcept {
  const double excess = v_scaled.cwiseAbs().cwiseProduct(inv_max_null_speed_).maxCoeff();
  return excess > 1.0 ? 1.0 / excess : 1.0;
}

void ControlLaw::update(const ControlLawInput& input, const ContactSpace& space, double period_s,
                        ControlLawState& state, ControlLawOutput& output) const noexcept {
  state.V_m_per_s = flushed(state.V_m_per_s * input.integral_decay);
  const double single = singleSpace(input, state);
  const double second = secondSpace(input, state);
  bool limited = false;
  output = {};
  switch (config_.variant) {
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
    const double share = speedShare(output.u_n * space.a_scaled);
    output.u_n *= share;
    limited = share < 1.0;
  }
  if (config_.order == 1) return;
  const double rate =
      period_s / (config_.time_constant_s * config_.time_constant_s * input.stiffness_N_per_m);
  if (!limited && !input.hold_integral)
    integrate(rate * input.F_p_N, input, period_s, state.V_m_per_s);
  if (has_second_space_)
    integrate(rate * (input.F_p_N - config_.activation_force_N), input, period_s, state.It_m_per_s);
}

void ControlLaw::integrate(double change_m_per_s, const ControlLawInput& input, double period_s,
                           double& integral_m_per_s) const noexcept {
  if (input.cut_m_per_s > 0.0)
    change_m_per_s -= period_s / config_.time_constant_s * input.cut_m_per_s;
  if (!input.is_followed || input.cut_m_per_s > 0.0) change_m_per_s = std::min(change_m_per_s, 0.0);
  const double lowest = std::min(0.0, integral_m_per_s);
  integral_m_per_s = std::max(lowest, integral_m_per_s + change_m_per_s);
}

}  // namespace tactus
