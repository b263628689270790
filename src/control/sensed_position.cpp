#include "tactus/control/sensed_position.h"

#include <algorithm>
#include <numbers>

#include "tactus/math/butterworth_step.h"

namespace tactus {
namespace {

/// A cut-off above rate / pi is no filter for this cycle; its model would ring.
constexpr double kMaxK = 1.0;

/// The same for every joint.
ScaledVector flushed(const ScaledVector& x) noexcept {
  return (x.array().abs() < 1e-100).select(0.0, x);
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
  // At the cycle's rate and without prewarping: K is rational in the period, and 15 Hz at 1 kHz is
  // met to 0.1 %.
  const double K = std::min(kMaxK, std::numbers::pi * filter_cutoff_hz_ * period_s);
  butterworthStep(state.lagged, K, state.s0, state.s1, state.s2, filtered);
  if (!is_new_sample) return;
  state.sensed_before = state.sensed;
  state.sensed = filtered;
  // A sample is early enough: between two of them nothing fades by two hundred decades.
  for (ScaledVector* fading : {&state.lagged, &state.s0, &state.s1, &state.s2})
    *fading = flushed(*fading);
}

}  // namespace tactus
