#include "tactus/control/approach_limit.h"

#include <algorithm>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// A smaller memory limits nothing that an arm could do, and would fade for minutes.
constexpr double kNoMemory_N_per_m = 1e-3;

/// -a^T (to - from): way towards the obstacle.
double approach(const JointVector& a, const ScaledVector& from, const ScaledVector& to) {
  double way = 0.0;
  for (int i = 0; i < a.size(); ++i) way += a[i] * (from[i] - to[i]);
  return way;
}

}  // namespace

ApproachLimit::ApproachLimit(const ControllerConfig& config)
    : config_(*config.force_control),
      smoother_(config_.estimator.value_or(StiffnessEstimatorConfig{}).min_force_change_N,
                config_.contact_threshold_N, *config.tactile_module),
      position_(config.drive_lag_s, config.tactile_module->filter_cutoff_hz) {
  if (config_.estimator) {
    estimator_.emplace(*config_.estimator, config_.assumed_stiffness_N_per_m,
                       config_.activation_force_N);
  }
}

ApproachLimitState ApproachLimit::initialState() const noexcept {
  ApproachLimitState state;
  state.smoother = smoother_.initialState();
  state.estimator.stiffness_N_per_m = config_.assumed_stiffness_N_per_m;
  state.estimator.stiffness_raw_N_per_m = config_.assumed_stiffness_N_per_m;
  return state;
}

void ApproachLimit::follow(const ContactPointState& sensor, const Pose& X_BaseModule,
                           ApproachLimitState& state) const noexcept {
  smoother_.update(sensor, X_BaseModule, state.smoother);
}

void ApproachLimit::estimate(const JointVector& a, double F_p_N, double period_s,
                             ApproachLimitState& state) const noexcept {
  const ContactPointState& contact = state.smoother.contact;
  if (F_p_N <= 0.0) {
    estimator_->release(period_s, state.estimator);
  } else if (contact.isNew()) {
    const double dx_m = approach(a, state.position.sensed_before, state.position.sensed);
    estimator_->touch({F_p_N, dx_m, contact.interval_s, state.smoother.significant_N},
                      state.estimator);
  }
}

void ApproachLimit::observe(const JointVector& a, double F_p_N, const JointVector& q_desired,
                            double period_s, ApproachLimitState& state) const noexcept {
  position_.update(q_desired, state.smoother.contact.isNew(), period_s, state.position);
  if (estimator_) estimate(a, F_p_N, period_s, state);
  const double c = state.estimator.stiffness_N_per_m;
  if (F_p_N > 0.0) {
    state.memory_N_per_m = std::max(c, config_.min_approach_stiffness_N_per_m);
  } else {
    state.memory_N_per_m -= lagShare(period_s, config_.time_constant_s) * state.memory_N_per_m;
    if (state.memory_N_per_m < kNoMemory_N_per_m) state.memory_N_per_m = 0.0;
  }
  state.way_ahead_m = approach(a, state.position.sensed, state.position.commanded);
}

double ApproachLimit::excess(double F_p_N, double v_res_m_per_s,
                             ApproachLimitState& state) const noexcept {
  const double m = state.memory_N_per_m;
  const double F_ahead_N = std::max(0.0, F_p_N + m * state.way_ahead_m);
  // T m (v_res + v_max): finite also where m has faded away.
  const double Tm = config_.time_constant_s * m;
  const double excess_N = Tm * v_res_m_per_s + config_.activation_force_N - F_ahead_N;
  state.is_limiting = excess_N < 0.0;
  return state.is_limiting ? excess_N / Tm : 0.0;
}

}  // namespace tactus
