#include "tactus/control/approach_estimator.h"

#include <algorithm>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// A shorter way is not known well enough to be divided by: drives and model differ by as much.
constexpr double kMinWay_m = 50e-6;
/// T_c: what was learnt of one obstacle is forgotten before the next.
constexpr double kForget_s = 1.0;

void rearm(double F_p_N, ApproachEstimatorState& state) {
  state.x_m = 0.0;
  state.F_ref_N = F_p_N;
}

void fall(double share, ApproachEstimatorState& state) {
  const double below = state.stiffness_raw_N_per_m - state.stiffness_N_per_m;
  if (below < 0.0) state.stiffness_N_per_m += share * below;
}

}  // namespace

double ApproachEstimator::clamp(double stiffness_N_per_m) const noexcept {
  return std::clamp(stiffness_N_per_m, config_.min_N_per_m, config_.max_N_per_m);
}

void ApproachEstimator::load(double F_p_N, double dF_N, double share,
                             ApproachEstimatorState& state) const noexcept {
  const bool is_far = F_p_N < far_from_activation_N_;
  const double F_min_N = config_.min_force_change_N;
  if (dF_N > F_min_N) {
    state.stiffness_raw_N_per_m = clamp(dF_N / std::max(state.x_m, kMinWay_m));
    state.stiffness_N_per_m = std::max(state.stiffness_N_per_m, state.stiffness_raw_N_per_m);
    if (is_far) fall(share, state);
    if (state.x_m > kMinWay_m) rearm(F_p_N, state);
  } else if (dF_N < -F_min_N) {
    rearm(F_p_N, state);
  } else if (is_far && state.x_m > kMinWay_m) {
    state.stiffness_raw_N_per_m = clamp((std::max(dF_N, 0.0) + F_min_N) / state.x_m);
    fall(share, state);
  }
}

void ApproachEstimator::unload(double F_p_N, double dF_N, double share,
                               ApproachEstimatorState& state) const noexcept {
  const double F_min_N = config_.min_force_change_N;
  if (dF_N < -F_min_N && state.x_m < -kMinWay_m) {
    state.stiffness_raw_N_per_m = clamp(dF_N / state.x_m);
    fall(share, state);
    rearm(F_p_N, state);
  } else if (dF_N > F_min_N) {
    rearm(F_p_N, state);
  }
}

void ApproachEstimator::update(double F_p_N, double dx_m, bool is_new_sample, double period_s,
                               ApproachEstimatorState& state) const noexcept {
  if (F_p_N <= 0.0) {
    rearm(0.0, state);
    state.F_before_N = 0.0;
    state.since_sample_s = 0.0;
    state.stiffness_N_per_m +=
        lagShare(period_s, kForget_s) * (assumed_N_per_m_ - state.stiffness_N_per_m);
    state.stiffness_raw_N_per_m = state.stiffness_N_per_m;
    return;
  }
  state.since_sample_s += period_s;
  if (!is_new_sample) return;
  const double share = lagShare(state.since_sample_s, config_.filter_time_constant_s);
  state.since_sample_s = 0.0;
  if (dx_m * state.x_m < 0.0) rearm(state.F_before_N, state);
  state.F_before_N = F_p_N;
  state.x_m += dx_m;
  const double dF_N = F_p_N - state.F_ref_N;
  if (dx_m > 0.0) {
    load(F_p_N, dF_N, share, state);
  } else {
    unload(F_p_N, dF_N, share, state);
  }
}

}  // namespace tactus
