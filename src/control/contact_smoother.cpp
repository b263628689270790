#include "tactus/control/contact_smoother.h"

#include <algorithm>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

constexpr double kSmoothing_s = 0.2;           ///< T_s
constexpr double kLearning = 0.01;             ///< a sample: settles within half a second at 4 ms
constexpr double kMedianOfNoise = 0.48;        ///< of |d2| / s: sqrt(2 ln 2) sqrt(6) / 6
constexpr double kMaxSignificantRatio = 10.0;  ///< s / s_min; more would be no sensor

}  // namespace

ContactSmootherState ContactSmoother::initialState(double position_m) const noexcept {
  ContactSmootherState state;
  state.significant_N = min_significant_N_;
  state.contact.position_m = position_m;
  return state;
}

void ContactSmoother::learnNoise(const Vector3& force_N,
                                 ContactSmootherState& state) const noexcept {
  const Vector3 d2_N = force_N - 2.0 * state.force_before_N + state.force_two_before_N;
  const bool is_large = d2_N.norm() > kMedianOfNoise * state.significant_N;
  state.significant_N =
      std::clamp(state.significant_N * (is_large ? 1.0 + kLearning : 1.0 - kLearning),
                 min_significant_N_, kMaxSignificantRatio * min_significant_N_);
  state.force_two_before_N = state.force_before_N;
  state.force_before_N = force_N;
}

void ContactSmoother::update(const ContactPointState& sensor,
                             ContactSmootherState& state) const noexcept {
  ContactPointState& contact = state.contact;
  contact.force_N = sensor.force_N;
  contact.interval_s = sensor.interval_s;
  if (!sensor.isNew()) return;
  const Vector3 force_N = sensor.force_N * sensor.direction;
  learnNoise(force_N, state);
  const Vector3 change_N = force_N - state.force_N;
  const double slow = lagShare(sensor.interval_s, kSmoothing_s);
  const double noise = state.significant_N * state.significant_N;
  const double share = 1.0 - (1.0 - slow) * std::min(1.0, noise / change_N.squaredNorm());
  state.force_N += share * change_N;
  state.magnitude_N += share * (sensor.force_N - state.magnitude_N);
  state.leverage_Nm += share * (sensor.force_N * sensor.position_m - state.leverage_Nm);
  const double length_N = state.force_N.norm();
  if (length_N <= kMinForceForDirection_N) return;
  contact.direction = state.force_N / length_N;
  contact.position_m = state.leverage_Nm / state.magnitude_N;
}

}  // namespace tactus
