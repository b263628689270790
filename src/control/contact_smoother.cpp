#include "tactus/control/contact_smoother.h"

#include <algorithm>
#include <cmath>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// T_s. One of several contacts holds F_th by motions of the null space that can be a hundred times
/// as large as what they move it by: it needs its direction better.
constexpr double kSmoothing_s = 1.0;
constexpr double kSmoothingOfSeveral_s = 4.0;
constexpr double kTurn = 0.05;      ///< theta_s, rad
constexpr double kLearning = 0.01;  ///< a sample: settles within half a second at 4 ms
/// The peak is remembered for kRinging / f_c; of what is left of it the filter shows 0.175 from the
/// other side after the shortest blow, less after others. Samples miss some of the peak, the more
/// the rarer they are: hence twice that, which does for periods up to 0.3 / f_c.
constexpr double kMaxRebound = 0.35;
constexpr double kRinging = 1.5;
constexpr double kGrowth = 1.2;                ///< of force from sample to sample in an impact
constexpr double kSureGrowth = 2.0;            ///< of s
constexpr double kMedianOfNoise = 0.48;        ///< of |d2| / s: sqrt(2 ln 2) sqrt(6) / 6
constexpr double kMaxSignificantRatio = 10.0;  ///< s / s_min; more would be no sensor

/// That says anything of point and direction.
double leastForce_N(const ForceGains& gains, bool is_one_of_several) {
  return is_one_of_several ? 0.5 * (gains.transition.release_force_N + gains.contact_threshold_N)
                           : gains.contact_threshold_N;
}

void normalise(Vector3& direction) {
  const double length = direction.norm();
  if (length > 0.0) direction /= length;
}

/// Where the cover touches stands still in the base frame, and the normal as far as the link's axis
/// lets it: both seen from the link that has moved.
void carry(const Pose& from, const Pose& to, double radius_m, ContactPointState& contact) {
  const Vector3 F_Base = from.R_AB.lazyProduct(contact.direction);
  const Vector3 p_Base = from.p_AB + contact.position_m * from.R_AB.col(0) - radius_m * F_Base;
  contact.position_m = to.R_AB.col(0).dot(p_Base - to.p_AB);
  contact.direction = Vector3(0.0, to.R_AB.col(1).dot(F_Base), to.R_AB.col(2).dot(F_Base));
  normalise(contact.direction);
}

void learnNoise(double min_significant_N, const Vector3& force_N, ContactSmootherState& state) {
  if (state.significant_N == 0.0) state.significant_N = min_significant_N;
  const Vector3 d2_N = force_N - 2.0 * state.force_before_N + state.force_two_before_N;
  const bool is_large = d2_N.norm() > kMedianOfNoise * state.significant_N;
  state.significant_N =
      std::clamp(state.significant_N * (is_large ? 1.0 + kLearning : 1.0 - kLearning),
                 min_significant_N, kMaxSignificantRatio * min_significant_N);
  state.force_two_before_N = state.force_before_N;
  state.force_before_N = force_N;
}

}  // namespace

ContactSmoother::ContactSmoother(const TactileModuleConfig& module, double friction_coefficient,
                                 bool is_one_of_several)
    : half_length_m_(0.5 * module.length_m),
      radius_m_(module.cover_radius_m),
      ringing_s_(kRinging / module.filter_cutoff_hz),
      max_turn_(2.0 * friction_coefficient / std::hypot(1.0, friction_coefficient)),
      max_shift_m_(2.0 * friction_coefficient * module.cover_radius_m),
      is_one_of_several_(is_one_of_several) {}

ContactSmootherState ContactSmoother::initialState() const noexcept {
  ContactSmootherState state;
  state.contact.position_m = half_length_m_;
  return state;
}

/// What the filter still shows of a blow turns a small force by any angle. Without friction that is
/// told by its other side alone.
bool ContactSmoother::isOfBlow(const ContactPointState& sensor,
                               const ContactSmootherState& state) const noexcept {
  return max_turn_ > 0.0 && sensor.force_N < kMaxRebound * state.peak_N;
}

bool ContactSmoother::isImpact(double force_N, const ContactSmootherState& state) const noexcept {
  const double before_N = state.force_before_N.norm();
  const double noise_N = is_one_of_several_ ? kSureGrowth * state.significant_N : 0.0;
  return force_N > kGrowth * before_N && force_N - before_N > noise_N;
}

bool ContactSmoother::isRebound(const ContactPointState& sensor,
                                ContactSmootherState& state) const noexcept {
  state.peak_N *= 1.0 - state.ringing.of(sensor.interval_s, ringing_s_);
  state.peak_N = std::max(flushed(state.peak_N), sensor.force_N);
  return sensor.force_N < kMaxRebound * state.peak_N &&
         sensor.direction.dot(state.contact.direction) < 0.0;
}

void ContactSmoother::update(const ForceGains& gains, const ContactPointState& sensor,
                             const Pose& X_BaseModule, ContactSmootherState& state) const noexcept {
  ContactPointState& contact = state.contact;
  contact.interval_s = sensor.interval_s;
  carry(state.X_BaseModule, X_BaseModule, radius_m_, contact);
  const double axis_turn = (X_BaseModule.R_AB.col(0) - state.X_BaseModule.R_AB.col(0)).norm();
  state.X_BaseModule = X_BaseModule;
  const bool is_rebound = isRebound(sensor, state);
  contact.force_N = is_rebound ? 0.0 : sensor.force_N;
  const bool grows = isImpact(sensor.force_N, state);
  learnNoise(gains.estimator.min_force_change_N, sensor.force_N * sensor.direction, state);
  const double weight = sensor.force_N * sensor.force_N;
  const double smoothing_s = is_one_of_several_ ? kSmoothingOfSeveral_s : kSmoothing_s;
  state.weight = flushed(state.weight * (1.0 - state.smoothing.of(sensor.interval_s, smoothing_s)) /
                         (1.0 + axis_turn / kTurn));
  if (is_rebound || sensor.force_N <= leastForce_N(gains, is_one_of_several_) || weight == 0.0)
    return;
  if (isOfBlow(sensor, state)) return;
  const Vector3 turn = sensor.direction - contact.direction;
  const double shift_m = sensor.position_m - contact.position_m;
  const double shift = shift_m / half_length_m_;
  const double d_N = sensor.force_N * std::sqrt(turn.squaredNorm() + shift * shift);
  const bool is_sliding = turn.norm() < max_turn_ && std::abs(shift_m) < max_shift_m_;
  state.weight = grows && !is_sliding ? weight : state.weight + weight;
  const double slow = weight / state.weight;
  const double ratio = is_sliding ? 1.0 : state.significant_N / d_N;
  const double share = 1.0 - (1.0 - slow) * std::min(1.0, ratio * ratio);
  contact.position_m += share * shift_m;
  contact.direction += share * turn;
  normalise(contact.direction);
}

}  // namespace tactus
