#include "tactus/control/clearance.h"

#include <algorithm>

namespace tactus {
namespace {

constexpr double kGamma_per_s = 5.0;
constexpr double kWallStiffness_N_per_m = 1e7;  ///< m_w
constexpr double kMaxMargin_m = 1e-3;
constexpr double kMarginShare = 0.1;
constexpr int kHalvings = 5;  ///< in the search for s

}  // namespace

Clearance::Clearance(const ControllerConfig& config)
    : config_(*config.clearance),
      limits_(config.limits),
      distances_(config.chain, config_),
      ways_(config, config_.capsules),
      reach_m_(
          std::max(config_.influence_distance_m, config_.avoid ? config_.avoid->distance_m : 0.0)),
      margin_m_(std::min(
          kMaxMargin_m, kMarginShare * (config_.influence_distance_m - config_.safe_distance_m))) {}

void Clearance::add(const NearBodies& near, const TaskKinematics& kinematics,
                    const ScaledVector& inv_sqrt_weights, const JointVector& q,
                    const JointVector& velocity_before, double period_s,
                    SpeedRows& rows) const noexcept {
  if (near.size == 0) return;
  const StoppingWay way = ways_.of(q, velocity_before, period_s);
  const double least_m = config_.safe_distance_m + margin_m_ +
                         0.5 * way.acceleration_m_per_s2 * way.time_s * way.time_s;
  const double rate_per_s = std::min(kGamma_per_s, 1.0 / way.time_s);
  for (int i = 0; i < near.size && rows.size < kMaxRows; ++i) {
    const NearBody& body = near.body[i];
    if (!(body.distance_m < config_.influence_distance_m)) continue;
    SpeedRow& row = rows.row[rows.size++];
    row.a_scaled = body.gradient[0];
    if (body.share > 0.0) row.a_scaled += body.share * (body.gradient[1] - body.gradient[0]);
    row.a_scaled.array() *= inv_sqrt_weights.array();
    row.a_task = kinematics.pseudoinverse.project(row.a_scaled);
    row.presence = std::min(1.0, (config_.influence_distance_m - body.distance_m) /
                                     (config_.influence_distance_m - config_.safe_distance_m));
    row.v_max_m_per_s = rate_per_s * (body.distance_m - least_m) / row.presence;
    row.damping_N_s_per_m = kWallStiffness_N_per_m / kGamma_per_s;
  }
}

bool Clearance::canStopAfter(const NearBodies& near, const JointVector& q,
                             const JointVector& velocity, double period_s) const noexcept {
  const StoppingWay way = ways_.of(q, velocity, period_s);
  for (int i = 0; i < q.size(); ++i) {
    const double q_end = q[i] + way.time_s * velocity[i];
    if (q_end < limits_.lower[i] || q_end > limits_.upper[i]) return false;
  }
  const double d_s = config_.safe_distance_m;
  if (near.beyond_m - way.time_s * way.speed_m_per_s < std::min(d_s, near.beyond_m)) return false;
  const double bend_m = 0.5 * way.acceleration_m_per_s2 * way.time_s * way.time_s;
  const ScaledVector step = scaled(velocity, ScaledVector::Constant(way.time_s));
  for (int i = 0; i < near.size; ++i) {
    const NearBody& body = near.body[i];
    const double least_m = std::min(d_s, body.distance_m) + bend_m;
    for (int end = 0; end < body.ends; ++end)
      if (body.height_m[end] + dot(body.gradient[end], step) < least_m) return false;
  }
  return true;
}

void Clearance::holdBack(const NearBodies& near, const JointVector& q,
                         const JointVector& velocity_before, double period_s,
                         JointVector& velocity) const noexcept {
  if (canStopAfter(near, q, velocity, period_s)) return;
  const double ramp_s = ways_.ramp_s(velocity_before);
  const double left = ramp_s > period_s ? 1.0 - period_s / ramp_s : 0.0;
  const JointVector ramp = left * velocity_before;
  const JointVector change = velocity - ramp;
  double share = 0.0;
  double step = 0.5;
  for (int i = 0; i < kHalvings; ++i, step *= 0.5) {
    const JointVector tried = ramp + (share + step) * change;
    if (canStopAfter(near, q, tried, period_s)) share += step;
  }
  velocity = ramp + share * change;
}

}  // namespace tactus
