#include "tactus/control/clearance.h"

#include <algorithm>

#include "tactus/math/pair.h"

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

Clearance::Pace Clearance::pace(const JointVector& q, const JointVector& velocity_before,
                                double period_s) const noexcept {
  const StoppingWay way = ways_.of(q, velocity_before, period_s);
  return {config_.safe_distance_m + margin_m_ +
              0.5 * way.acceleration_m_per_s2 * way.time_s * way.time_s,
          std::min(kGamma_per_s, 1.0 / way.time_s)};
}

Clearance::ApproachRange Clearance::range(const NearBody& body, const Pace& pace) const noexcept {
  const double presence =
      std::min(1.0, (config_.influence_distance_m - body.distance_m) /
                        (config_.influence_distance_m - config_.safe_distance_m));
  const double speed = pace.rate_per_s * (body.distance_m - pace.least_m);
  return {speed > 0.0 ? speed / presence : speed * presence, presence};
}

void Clearance::add(const NearBodies& near, const TaskKinematics& kinematics,
                    const ScaledVector& inv_sqrt_weights, const JointVector& q,
                    const JointVector& velocity_before, double period_s,
                    SpeedRows& rows) const noexcept {
  if (near.size == 0) return;
  const Pace pace = this->pace(q, velocity_before, period_s);
  for (int i = 0; i < near.size; ++i) {
    const NearBody& body = near.body[i];
    if (!(body.distance_m < config_.influence_distance_m)) continue;
    const ApproachRange range = this->range(body, pace);
    SpeedRow& row = rows.row[rows.size++];
    row.a_scaled = distances_.gradient(kinematics.pose, body).cwiseProduct(inv_sqrt_weights);
    row.a_task = kinematics.pseudoinverse.project(row.a_scaled);
    row.v_max_m_per_s = range.v_max_m_per_s;
    row.presence = range.presence;
    row.damping_N_s_per_m = kWallStiffness_N_per_m / kGamma_per_s;
  }
}

bool Clearance::isKept(const ChainPose& pose, const NearBodies& near, const ScaledVector& velocity,
                       const JointVector& q, const JointVector& velocity_before,
                       double period_s) const noexcept {
  if (near.size == 0) return true;
  const Pace pace = this->pace(q, velocity_before, period_s);
  const SpeedSums sums = ways_.speedSums(q, velocity);
  for (int i = 0; i < near.size; ++i) {
    const NearBody& body = near.body[i];
    if (!(body.distance_m < config_.influence_distance_m)) continue;
    const double v_max = range(body, pace).v_max_m_per_s;
    const MovingJoints joints = distances_.movingJoints(body);
    if (sums[joints.end] - sums[joints.begin] <= v_max) continue;
    if (!(dot(distances_.gradient(pose, body), velocity) >= -v_max)) return false;
  }
  return true;
}

bool Clearance::staysWithinLimits(const JointVector& q, const JointVector& velocity,
                                  double time_s) const noexcept {
  const auto joints = static_cast<int>(q.size());
  int i = 0;
  for (; i + 1 < joints; i += 2) {
    const Pair q_end = pairAt(q.data() + i) + time_s * pairAt(velocity.data() + i);
    const PairMask is_out =
        (q_end < pairAt(limits_.lower.data() + i)) | (q_end > pairAt(limits_.upper.data() + i));
    if (isAny(is_out)) return false;
  }
  if (i == joints) return true;
  const double q_end = q[i] + time_s * velocity[i];
  return !(q_end < limits_.lower[i] || q_end > limits_.upper[i]);
}

bool Clearance::canStopAfter(const ChainPose& pose, const NearBodies& near, const JointVector& q,
                             const JointVector& velocity, double period_s) const noexcept {
  const StoppingWay way = ways_.of(q, velocity, period_s);
  if (!staysWithinLimits(q, velocity, way.time_s)) return false;
  const double d_s = config_.safe_distance_m;
  const double furthest_m = way.time_s * way.speed_m_per_s;
  if (near.beyond_m - furthest_m < std::min(d_s, near.beyond_m)) return false;
  const double bend_m = 0.5 * way.acceleration_m_per_s2 * way.time_s * way.time_s;
  for (int i = 0; i < near.size; ++i) {
    const NearBody& body = near.body[i];
    if (body.distance_m - furthest_m >= d_s) continue;
    const double left_m = distances_.leftAfter_m(pose, body, way.time_s, velocity) - bend_m;
    if (left_m < std::min(d_s, body.distance_m)) return false;
  }
  return true;
}

void Clearance::holdBack(const ChainPose& pose, const NearBodies& near, const JointVector& q,
                         const JointVector& velocity_before, double period_s,
                         JointVector& velocity) const noexcept {
  if (canStopAfter(pose, near, q, velocity, period_s)) return;
  const double ramp_s = ways_.ramp_s(velocity_before);
  const double left = ramp_s > period_s ? 1.0 - period_s / ramp_s : 0.0;
  const JointVector ramp = left * velocity_before;
  const JointVector change = velocity - ramp;
  double share = 0.0;
  double step = 0.5;
  for (int i = 0; i < kHalvings; ++i, step *= 0.5) {
    const JointVector tried = ramp + (share + step) * change;
    if (canStopAfter(pose, near, q, tried, period_s)) share += step;
  }
  velocity = ramp + share * change;
}

}  // namespace tactus
