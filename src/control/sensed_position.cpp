#include "tactus/control/sensed_position.h"

#include <algorithm>
#include <numbers>

namespace tactus {
namespace {

/// A cut-off above rate / pi is no filter for this cycle; its model would ring.
constexpr double kMaxK = 1.0;

/// The same for every joint.
ScaledVector flushed(const ScaledVector& x) noexcept {
  return (x.array().abs() < 1e-100).select(0.0, x);
}

/// One step of the 3rd-order Butterworth filter of filter.h for all joints, at the cycle's rate and
/// without prewarping: K is rational in the period, and 15 Hz at 1 kHz is met to 0.1 %.
void filter(const ScaledVector& input, double K, SensedPositionState& state,
            ScaledVector& output) noexcept {
  const double K2 = K * K;
  const double K3 = K2 * K;
  const double inv_a0 = 1.0 / (K3 + 2.0 * K2 + 2.0 * K + 1.0);
  const double b = K3 * inv_a0;
  const double a1 = (3.0 * K3 + 2.0 * K2 - 2.0 * K - 3.0) * inv_a0;
  const double a2 = (3.0 * K3 - 2.0 * K2 - 2.0 * K + 3.0) * inv_a0;
  const double a3 = (K3 - 2.0 * K2 + 2.0 * K - 1.0) * inv_a0;
  output = b * input + state.s0;
  state.s0 = 3.0 * b * input - a1 * output + state.s1;
  state.s1 = 3.0 * b * input - a2 * output + state.s2;
  state.s2 = b * input - a3 * output;
}

}  // namespace

void SensedPosition::update(const JointVector& q_desired, bool is_new_sample, double period_s,
                            SensedPositionState& state) const noexcept {
  if (!state.has_started) {
    state.origin = q_desired;
    state.has_started = true;
  }
  for (int i = 0; i < q_desired.size(); ++i) state.commanded[i] = q_desired[i] - state.origin[i];
  state.lagged += state.drive_lag.of(period_s, drive_lag_s_) * (state.commanded - state.lagged);
  ScaledVector filtered;
  filter(state.lagged, std::min(kMaxK, std::numbers::pi * filter_cutoff_hz_ * period_s), state,
         filtered);
  if (!is_new_sample) return;
  state.sensed_before = state.sensed;
  state.sensed = filtered;
  // A sample is early enough: between two of them nothing fades by two hundred decades.
  for (ScaledVector* fading : {&state.lagged, &state.s0, &state.s1, &state.s2})
    *fading = flushed(*fading);
}

}  // namespace tactus
