#include "tactus/control/stiffness_centre.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kLeastShift_m = 0.01;
constexpr double kLeastChange = 0.1;  ///< of the force: less is sliding
constexpr double kMaxWeight = 30.0;   ///< in s^2, of what was before
constexpr double kDoubt = 0.5;        ///< of the length, where all that is known is one s
constexpr double kStale_s = 1.0;

double alongAxis(const Pose& X_BaseModule, const Vector3& p_Base) {
  return X_BaseModule.R_AB.col(0).dot(p_Base - X_BaseModule.p_AB);
}

/// On the cover where a contact is.
Vector3 onCover(const Pose& X_BaseModule, double position_m, double radius_m,
                const Vector3& direction) {
  return X_BaseModule.p_AB + position_m * X_BaseModule.R_AB.col(0) -
         radius_m * X_BaseModule.R_AB.lazyProduct(direction);
}

}  // namespace

StiffnessCentre::StiffnessCentre(const TactileModuleConfig& module, double friction_coefficient)
    : length_m_(module.length_m),
      radius_m_(module.cover_radius_m),
      least_shift_m_(kLeastShift_m + friction_coefficient * module.cover_radius_m) {}

void StiffnessCentre::update(const ForceGains& gains, const ContactPointState& sensor,
                             const ContactSmootherState& smoother,
                             StiffnessCentreState& state) const noexcept {
  const ContactPointState& contact = smoother.contact;
  if (contact.force_N <= gains.contact_threshold_N) {
    state.has_reference = false;
    state.shift_m = shift_m(smoother, state);
    return;
  }
  const Pose& X = smoother.X_BaseModule;
  const double s = smoother.significant_N;
  const double F_N = sensor.force_N * sensor.direction.dot(contact.direction);
  state.since_s += sensor.interval_s;
  bool is_done = !state.has_reference || state.since_s >= kStale_s;
  if (state.has_reference) {
    const double F_ref_N = state.F_BaseRef.dot(X.R_AB.lazyProduct(contact.direction));
    const double dF_N = F_N - F_ref_N;
    if (std::abs(dF_N) > std::max(s, kLeastChange * F_N)) {
      const double dM_Nm = sensor.position_m * F_N - alongAxis(X, state.p_BaseRef) * F_ref_N;
      const double x = std::clamp(dM_Nm / dF_N, 0.0, length_m_);
      const double x_c = state.weight > 0.0 ? alongAxis(X, state.p_Base) : x;
      state.weight = std::min(state.weight, kMaxWeight * s * s) + dF_N * dF_N;
      state.p_Base =
          onCover(X, x_c + dF_N * dF_N / state.weight * (x - x_c), radius_m_, contact.direction);
      is_done = true;
    }
  }
  if (is_done) {
    state.has_reference = true;
    state.F_BaseRef = X.R_AB.lazyProduct(sensor.force_N * sensor.direction);
    state.p_BaseRef = onCover(X, sensor.position_m, radius_m_, sensor.direction);
    state.since_s = 0.0;
  }
  state.shift_m = shift_m(smoother, state);
}

double StiffnessCentre::shift_m(const ContactSmootherState& smoother,
                                const StiffnessCentreState& state) const noexcept {
  if (state.weight == 0.0) return 0.0;
  const double x_c = std::clamp(alongAxis(smoother.X_BaseModule, state.p_Base), 0.0, length_m_);
  const double apart_m = x_c - smoother.contact.position_m;
  const double doubt_m =
      least_shift_m_ + kDoubt * length_m_ * smoother.significant_N / std::sqrt(state.weight);
  return apart_m > 0.0 ? std::max(0.0, apart_m - doubt_m) : std::min(0.0, apart_m + doubt_m);
}

}  // namespace tactus
