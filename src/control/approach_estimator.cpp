#include "tactus/control/approach_estimator.h"

#include <algorithm>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// x_min: a shorter way is not known well enough to be divided by; drives and model differ by it.
constexpr double kMinWay_m = 50e-6;
/// T_c: what was learnt of one obstacle is forgotten before the next.
constexpr double kForgetting_s = 1.0;

void rearm(double F_p_N, ApproachEstimatorState& state) {
  state.x_m = 0.0;
  state.F_ref_N = F_p_N;
}

}  // namespace

void ApproachEstimator::learn(double stiffness_N_per_m, double falling_s,
                              ApproachEstimatorState& state) const noexcept {
  const double r = std::clamp(stiffness_N_per_m, config_.min_N_per_m, config_.max_N_per_m);
  state.stiffness_raw_N_per_m = r;
  if (r < state.stiffness_N_per_m) {
    state.stiffness_N_per_m +=
        lagShare(falling_s, config_.filter_time_constant_s) * (r - state.stiffness_N_per_m);
  }
}

void ApproachEstimator::load(const ApproachSample& sample,
                             ApproachEstimatorState& state) const noexcept {
  const bool is_far = sample.F_p_N < far_from_activation_N_;
  const double dF_N = sample.F_p_N - state.F_ref_N;
  if (dF_N > sample.significant_N) {
    // Over too short a way r is a lower bound: nothing that c could fall to.
    const bool is_known = state.x_m > kMinWay_m;
    learn(dF_N / std::max(state.x_m, kMinWay_m), is_known && is_far ? sample.interval_s : 0.0,
          state);
    state.stiffness_N_per_m = std::max(state.stiffness_N_per_m, state.stiffness_raw_N_per_m);
    if (is_known) rearm(sample.F_p_N, state);
  } else if (dF_N < -sample.significant_N) {
    rearm(sample.F_p_N, state);
  } else if (is_far && state.x_m > kMinWay_m) {
    learn((std::max(dF_N, 0.0) + sample.significant_N) / state.x_m, sample.interval_s, state);
  }
}

void ApproachEstimator::unload(const ApproachSample& sample,
                               ApproachEstimatorState& state) const noexcept {
  const double dF_N = sample.F_p_N - state.F_ref_N;
  if (dF_N < -sample.significant_N && state.x_m < -kMinWay_m) {
    learn(dF_N / state.x_m, sample.interval_s, state);
    rearm(sample.F_p_N, state);
  } else if (dF_N > sample.significant_N) {
    rearm(sample.F_p_N, state);
  }
}

void ApproachEstimator::touch(const ApproachSample& sample,
                              ApproachEstimatorState& state) const noexcept {
  if (sample.dx_m * state.x_m < 0.0) rearm(state.F_before_N, state);
  state.F_before_N = sample.F_p_N;
  state.x_m += sample.dx_m;
  if (sample.dx_m > 0.0) {
    load(sample, state);
  } else {
    unload(sample, state);
  }
}

void ApproachEstimator::release(double period_s, ApproachEstimatorState& state) const noexcept {
  rearm(0.0, state);
  state.F_before_N = 0.0;
  state.stiffness_N_per_m +=
      lagShare(period_s, kForgetting_s) * (assumed_N_per_m_ - state.stiffness_N_per_m);
  state.stiffness_raw_N_per_m = state.stiffness_N_per_m;
}

}  // namespace tactus
