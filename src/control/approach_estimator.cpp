#include "tactus/control/approach_estimator.h"

#include <algorithm>

#include "tactus/control/obstacle_speed.h"

namespace tactus {
namespace {

/// x_min: a shorter way is not known well enough to be divided by; drives and model differ by it.
constexpr double kMinWay_m = 50e-6;
/// v_s: slower, and an obstacle that comes may be half of the quotient. No more than four of it:
/// for T of 0.1 s and more c_e / c may be five.
constexpr double kSlow_m_per_s = 0.01;
constexpr double kMaxLengthening = 4.0;
/// Up to here an obstacle that comes costs little whatever is taken for its stiffness.
constexpr double kHarmless_N_per_m = 2.5e3;
/// T_c: what was learnt of one obstacle is forgotten before the next.
constexpr double kForgetting_s = 1.0;

void rearm(double F_p_N, ApproachEstimatorState& state) {
  state.x_m = 0.0;
  state.F_ref_N = F_p_N;
  state.limited_s = 0.0;
}

/// r = stiffness, clamped; c falls towards it for falling_s.
void learn(const StiffnessEstimatorGains& gains, double stiffness_N_per_m, double falling_s,
           ApproachEstimatorState& state) noexcept {
  const double r = std::clamp(stiffness_N_per_m, gains.min_N_per_m, gains.max_N_per_m);
  state.stiffness_raw_N_per_m = r;
  if (r < state.stiffness_N_per_m) {
    state.stiffness_N_per_m +=
        state.filter.of(falling_s, gains.filter_time_constant_s) * (r - state.stiffness_N_per_m);
  }
}

/// By which a change of force is divided where c rises.
double risingWay(const ApproachEstimatorState& state) {
  const double way_m = std::max(state.x_m, kMinWay_m);
  if (state.stiffness_N_per_m > kSoftContact_N_per_m) return way_m;
  return std::clamp(kSlow_m_per_s * state.limited_s, way_m, kMaxLengthening * way_m);
}

void load(const ForceGains& gains, const ApproachSample& sample,
          ApproachEstimatorState& state) noexcept {
  const bool is_far = sample.F_p_N < 0.5 * gains.activation_force_N;
  const double dF_N = sample.F_p_N - state.F_ref_N;
  if (dF_N > sample.significant_N) {
    // Over too short a way r is a lower bound: nothing that c could fall to.
    const bool is_known = state.x_m > kMinWay_m;
    const double risen_N_per_m = std::max(kHarmless_N_per_m, dF_N / risingWay(state));
    learn(gains.estimator, dF_N / std::max(state.x_m, kMinWay_m),
          is_known && is_far ? sample.interval_s : 0.0, state);
    state.stiffness_N_per_m =
        std::max(state.stiffness_N_per_m, std::min(state.stiffness_raw_N_per_m, risen_N_per_m));
    if (is_known) rearm(sample.F_p_N, state);
  } else if (dF_N < -sample.significant_N) {
    rearm(sample.F_p_N, state);
  } else if (is_far && state.x_m > kMinWay_m) {
    learn(gains.estimator, (std::max(dF_N, 0.0) + sample.significant_N) / state.x_m,
          sample.interval_s, state);
  }
}

void unload(const ForceGains& gains, const ApproachSample& sample,
            ApproachEstimatorState& state) noexcept {
  const double dF_N = sample.F_p_N - state.F_ref_N;
  if (dF_N < -sample.significant_N && state.x_m < -kMinWay_m) {
    learn(gains.estimator, dF_N / state.x_m, sample.interval_s, state);
    rearm(sample.F_p_N, state);
  } else if (dF_N > sample.significant_N) {
    rearm(sample.F_p_N, state);
  }
}

}  // namespace

void estimateInContact(const ForceGains& gains, const ApproachSample& sample,
                       ApproachEstimatorState& state) noexcept {
  if (sample.dx_m * state.x_m < 0.0) rearm(state.F_before_N, state);
  state.F_before_N = sample.F_p_N;
  state.x_m += sample.dx_m;
  if (sample.is_limiting) state.limited_s += sample.interval_s;
  if (sample.dx_m > 0.0) {
    load(gains, sample, state);
  } else {
    unload(gains, sample, state);
  }
}

void beginWay(double F_p_N, ApproachEstimatorState& state) noexcept {
  rearm(F_p_N, state);
  state.F_before_N = F_p_N;
}

void forgetContact(const ForceGains& gains, double duration_s,
                   ApproachEstimatorState& state) noexcept {
  beginWay(0.0, state);
  state.stiffness_N_per_m += state.forgetting.of(duration_s, kForgetting_s) *
                             (gains.assumed_stiffness_N_per_m - state.stiffness_N_per_m);
  state.stiffness_raw_N_per_m = state.stiffness_N_per_m;
}

}  // namespace tactus
