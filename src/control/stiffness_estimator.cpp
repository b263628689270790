#include "tactus/control/stiffness_estimator.h"

#include <algorithm>

namespace tactus {
namespace {

constexpr double kMinApproach_m = 1e-6;

void trigger(const StiffnessEstimatorGains& gains, double F_p_N,
             StiffnessEstimatorState& state) noexcept {
  if (state.x_int_m > kMinApproach_m) {
    state.stiffness_raw_N_per_m =
        std::clamp((F_p_N - state.F_prev_N) / state.x_int_m, gains.min_N_per_m, gains.max_N_per_m);
  }
  state.F_prev_N = F_p_N;
  state.x_int_m = 0.0;
}

}  // namespace

void estimateStiffness(const StiffnessEstimatorGains& gains, double F_p_N, double approach_m_per_s,
                       double period_s, StiffnessEstimatorState& state) noexcept {
  if (F_p_N <= 0.0) {
    state.x_int_m = state.v_prev_m_per_s = state.F_prev_N = 0.0;
    state.stiffness_raw_N_per_m = state.stiffness_N_per_m;
    return;
  }
  if (approach_m_per_s <= 0.0) {
    state.x_int_m = 0.0;
    state.v_prev_m_per_s = approach_m_per_s;
    state.F_prev_N = F_p_N;
    return;
  }
  state.x_int_m += 0.5 * (approach_m_per_s + state.v_prev_m_per_s) * period_s;
  state.v_prev_m_per_s = approach_m_per_s;
  if (F_p_N - state.F_prev_N > gains.min_force_change_N) trigger(gains, F_p_N, state);
  state.stiffness_N_per_m += state.filter.of(period_s, gains.filter_time_constant_s) *
                             (state.stiffness_raw_N_per_m - state.stiffness_N_per_m);
}

}  // namespace tactus
