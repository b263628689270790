#include "tactus/control/approach_limit.h"

#include <algorithm>

namespace tactus {
namespace {

/// A smaller memory limits nothing that an arm could do, and would fade for minutes.
constexpr double kNoMemory_N_per_m = 1e-3;

/// -a^T (to - from): way towards the obstacle.
double approach(const ScaledVector& a, int joints, const ScaledVector& from,
                const ScaledVector& to) {
  double way = 0.0;
  for (int i = 0; i < joints; ++i) way += a[i] * (from[i] - to[i]);
  return way;
}

}  // namespace

ApproachLimit::ApproachLimit(const ControllerConfig& config, const TactileModuleConfig& module)
    : has_estimator_(config.force_control->has_estimator),
      smoother_(module, config.force_control->friction_coefficient, hasContactRows(config)),
      position_(config.drive_lag_s, module.filter_cutoff_hz) {}

ApproachLimitState ApproachLimit::initialState() const noexcept {
  ApproachLimitState state;
  state.smoother = smoother_.initialState();
  return state;
}

void ApproachLimit::follow(const ForceGains& gains, const ContactPointState& sensor,
                           const Pose& X_BaseModule, ApproachLimitState& state) const noexcept {
  smoother_.update(gains, sensor, X_BaseModule, state.smoother);
}

void ApproachLimit::learn(const ForceGains& gains, const ScaledVector& a, int joints, double F_p_N,
                          ApproachLimitState& state) const noexcept {
  const double interval_s = state.smoother.contact.interval_s;
  const double dx_m = approach(a, joints, state.position.sensed_before, state.position.sensed);
  if (has_estimator_) {
    estimateInContact(gains,
                      {F_p_N, dx_m, interval_s, state.smoother.significant_N, state.is_limiting},
                      state.estimator);
  }
  const double m = stiffnessInContact(gains, state.estimator);
  followObstacle(gains, {F_p_N, m, dx_m, interval_s, state.is_limiting}, state.obstacle);
}

void ApproachLimit::observe(const ForceGains& gains, const ScaledVector& a, const FeltForce& force,
                            const JointVector& q_desired, double period_s,
                            ApproachLimitState& state) const noexcept {
  const bool is_new = state.smoother.contact.isNew();
  position_.update(q_desired, is_new, period_s, state.position);
  ApproachEstimatorState& estimator = state.estimator;
  if (!has_estimator_ || estimator.stiffness_N_per_m == 0.0) {
    estimator.stiffness_N_per_m = gains.assumed_stiffness_N_per_m;
    estimator.stiffness_raw_N_per_m = gains.assumed_stiffness_N_per_m;
  }
  const auto joints = static_cast<int>(q_desired.size());
  if (force.F_p_N > 0.0) {
    if (is_new) learn(gains, a, joints, force.F_p_N, state);
    state.memory_N_per_m = stiffnessInContact(gains, estimator);
  } else {
    if (has_estimator_) forgetContact(gains, (1.0 - force.nearness) * period_s, estimator);
    state.obstacle.v_m_per_s = state.obstacle.F_before_N = state.obstacle.high_s = 0.0;
    const double fade = state.fade.of(period_s, gains.time_constant_s) * force.fading;
    state.memory_N_per_m -= fade * state.memory_N_per_m;
    if (state.memory_N_per_m < kNoMemory_N_per_m) state.memory_N_per_m = 0.0;
  }
  state.way_ahead_m = approach(a, joints, state.position.sensed, state.position.commanded);
}

void ApproachLimit::rest(const ForceGains& gains, double F_p_N,
                         ApproachLimitState& state) const noexcept {
  if (!has_estimator_) return;
  ApproachEstimatorState& estimator = state.estimator;
  if (F_p_N <= 0.0 || state.rested_N_per_m == 0.0)
    state.rested_N_per_m = estimator.stiffness_N_per_m;
  if (F_p_N <= 0.0) return;
  estimator.stiffness_N_per_m = estimator.stiffness_raw_N_per_m = state.rested_N_per_m;
  beginWay(F_p_N, estimator);
  state.memory_N_per_m = stiffnessInContact(gains, estimator);
}

double ApproachLimit::excess(const ForceGains& gains, double F_p_N, double v_res_m_per_s,
                             ApproachLimitState& state) const noexcept {
  const double m = state.memory_N_per_m;
  const double F_ahead_N = std::max(0.0, F_p_N + m * state.way_ahead_m);
  // T m (v_res + v_max): finite also where m has faded away.
  const double Tm = gains.time_constant_s * m;
  const double excess_N =
      Tm * (v_res_m_per_s - state.obstacle.v_m_per_s) + gains.activation_force_N - F_ahead_N;
  state.is_limiting = excess_N < 0.0;
  return state.is_limiting ? excess_N / Tm : 0.0;
}

void ApproachLimit::limitRows(const ForceGains& gains, double F_p_N, double cosine, double presence,
                              const ApproachLimitState& state, int first,
                              SpeedRows& rows) const noexcept {
  const double m = state.memory_N_per_m;
  const double F_ahead_N = std::max(0.0, F_p_N + m * state.way_ahead_m);
  const double Tm = gains.time_constant_s * m;
  const double v_max_m_per_s =
      cosine * ((gains.activation_force_N - F_ahead_N) / Tm - state.obstacle.v_m_per_s);
  for (int i = first; i < rows.size; ++i) {
    rows.row[i].v_max_m_per_s = v_max_m_per_s;
    rows.row[i].damping_N_s_per_m = Tm;
    rows.row[i].presence = presence;
  }
}

}  // namespace tactus
