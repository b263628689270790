#include "tactus/control/approach_limit.h"

#include <algorithm>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// -a^T v: along the contact force, positive towards the obstacle.
double approach(const JointVector& a, const ScaledVector& from, const ScaledVector& to) {
  double way = 0.0;
  for (int i = 0; i < a.size(); ++i) way += a[i] * (from[i] - to[i]);
  return way;
}

}  // namespace

ApproachLimit::ApproachLimit(const ControllerConfig& config)
    : config_(*config.force_control),
      position_(config.drive_lag_s, config.tactile_module->filter_cutoff_hz) {
  if (config_.estimator) {
    estimator_.emplace(*config_.estimator, config_.assumed_stiffness_N_per_m,
                       config_.activation_force_N);
  }
}

ApproachLimitState ApproachLimit::initialState() const noexcept {
  ApproachLimitState state;
  state.estimator.stiffness_N_per_m = config_.assumed_stiffness_N_per_m;
  state.estimator.stiffness_raw_N_per_m = config_.assumed_stiffness_N_per_m;
  return state;
}

double ApproachLimit::observe(const ApproachContact& contact, const JointVector& q_desired,
                              double period_s, ApproachLimitState& state) const noexcept {
  SensedPositionState& position = state.position;
  position_.update(q_desired, contact.is_new_sample, period_s, position);
  if (estimator_) {
    const double dx_m = approach(contact.a, position.sensed_before, position.sensed);
    estimator_->update(contact.F_p_N, dx_m, contact.is_new_sample, period_s, state.estimator);
  }
  if (contact.F_p_N > 0.0) {
    state.memory_N_per_m =
        std::max(state.estimator.stiffness_N_per_m, config_.approach_limit.min_stiffness_N_per_m);
  } else {
    state.memory_N_per_m -=
        lagShare(period_s, config_.approach_limit.memory_s) * state.memory_N_per_m;
  }
  state.way_ahead_m = approach(contact.a, position.sensed, position.commanded);
  return std::max(0.0, contact.F_p_N + state.estimator.stiffness_N_per_m * state.way_ahead_m);
}

double ApproachLimit::excess(const ApproachContact& contact, double v_res_m_per_s,
                             const ApproachLimitState& state) const noexcept {
  const double m = state.memory_N_per_m;
  const double F_ahead_N = std::max(0.0, contact.F_p_N + m * state.way_ahead_m);
  // v_res + v_max < 0, without a division by an m that has faded away.
  const double Tm = config_.time_constant_s * m;
  const double excess = Tm * v_res_m_per_s + config_.activation_force_N - F_ahead_N;
  return excess < 0.0 ? excess / Tm : 0.0;
}

}  // namespace tactus
