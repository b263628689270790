#include "tactus/control/acceleration_law.h"

#include <algorithm>
#include <stdexcept>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

bool hasAccelerationLaw(const ForceControlConfig& config) {
  return config.order == 2 &&
         (config.variant == Variant::kNullSpace || config.variant == Variant::kNullTask ||
          config.variant == Variant::kNullLimit);
}

/// What a cycle adds to the contact point's velocity.
struct TargetStep {
  double share;           ///< of k_v
  double per_N;           ///< dt / (T^2 c), m/s/N
  double damped_m_per_s;  ///< 2 d / T y_dot dt; 0 out of contact
};

TargetStep targetStep(const ForceGains& gains, const ControlLawInput& input, double y_dot_m_per_s,
                      double period_s) {
  const double T_s = gains.time_constant_s;
  const double damped = input.F_p_N != 0.0 ? lagShare(period_s, 0.5 * T_s / gains.damping) : 0.0;
  return {velocityShare(gains, period_s), period_s / (T_s * T_s * input.stiffness_N_per_m),
          damped * y_dot_m_per_s};
}

/// s_n a cycle later. x_change: of the free motion towards or from the obstacle. Below its floor,
/// the feedforward, it is only while k_v brings it there; null_limit's goes lower below F_th.
double nullSpeed(const ForceGains& gains, const ControlLawInput& input, const TargetStep& step,
                 double x_dot_eff, double x_change, double s_n) {
  const double P = 2.0 * gains.damping / (gains.time_constant_s * input.stiffness_N_per_m);
  const double floor = P * std::min(0.0, input.F_p_N) - input.x_dot_ff_m_per_s;
  const double gamma = x_dot_eff < 0.0 ? input.x_dot_ff_m_per_s / x_dot_eff : 0.0;
  const double to_floor = step.share * (floor - s_n);
  const double fading = std::min(step.share, 1.0 - input.integral_decay);
  const double pushed = step.per_N * input.F_p_N - step.damped_m_per_s - gamma * x_change +
                        fading * std::min(0.0, floor - s_n);
  return s_n + std::max(to_floor, pushed + std::max(0.0, to_floor));
}

/// s_t likewise.
double taskSpeed(double excess_N, const TargetStep& step, double s_t, double& open) {
  if (excess_N < 0.0 && open <= 0.0) {
    open = 0.0;
    return s_t - step.share * s_t;
  }
  open = s_t + std::max(-step.share * s_t, step.per_N * excess_N - step.damped_m_per_s);
  return open;
}

}  // namespace

AccelerationLaw::AccelerationLaw(const ForceControlConfig& config)
    : has_task_space_(config.variant == Variant::kNullTask) {
  if (!hasAccelerationLaw(config))
    throw std::invalid_argument("no law of this variant and order at the acceleration level");
}

void AccelerationLaw::update(const ForceGains& gains, const ControlLawInput& input,
                             double curvature_m_per_s2, const FreeAcceleration& free,
                             const TaskKinematics& kinematics, const ContactSpace& space,
                             double period_s, ControlLawState& state, Motion& motion,
                             ControlLawOutput& output) const noexcept {
  const WeightedPseudoinverse& pseudoinverse = kinematics.pseudoinverse;
  const int task_size = pseudoinverse.taskSize();
  const TargetStep step = targetStep(gains, input, dot(space.a_scaled, free.v_before), period_s);
  // What the previous command has beside the free motion, both carried on to now; N comes later.
  const PaddedTaskVector y_change = period_s * pseudoinverse.solve(free.w_dd);
  PaddedTaskVector y_rest = free.y_before + y_change - kinematics.y_eff;
  ScaledVector v_rest = free.v_before + free.cost_change - motion.v_scaled;

  const double s_n =
      dot(space.a_scaled, v_rest) - dot(space.a_task, pseudoinverse.project(v_rest), task_size);
  const double x_change = dot(space.a_task, y_change, task_size) + period_s * curvature_m_per_s2;
  const double inv_k_n = invertRegularised(space.k_n, space.k_j);
  v_rest -= s_n * inv_k_n * space.a_scaled;
  output.u_n = -inv_k_n * nullSpeed(gains, input, step, space.x_dot_eff_m_per_s, x_change, s_n);
  if (has_task_space_) {
    const double s_t = dot(space.a_task, y_rest, task_size);
    const double inv_k_t = invertRegularised(space.k_t, space.k_j);
    y_rest -= s_t * inv_k_t * space.a_task;
    output.u_t =
        -inv_k_t * taskSpeed(input.F_p_N - gains.activation_force_N, step, s_t, state.It_m_per_s);
  }
  motion.v_scaled += (1.0 - step.share) * v_rest;
  motion.y =
      kinematics.y_eff + (1.0 - step.share) * y_rest - pseudoinverse.project(motion.v_scaled);
}

double velocityShare(const ForceGains& gains, double period_s) noexcept {
  return lagShare(period_s, 1.0 / gains.velocity_gain_per_s);
}

}  // namespace tactus
