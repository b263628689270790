#include "tactus/control/joint_limit_rows.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kNear = 0.25;           ///< m or rad
constexpr double kApproach_per_s = 5.0;  ///< gamma
constexpr double kScaledLength = 0.3;    ///< of W^-1/2 a
/// A limit does not yield to what presses against the arm.
constexpr double kDamping_N_s_per_m = 2e6;

}  // namespace

bool JointLimitRows::find(const JointVector& q, int i, double share, Limit& limit) const noexcept {
  const double to_lower = q[i] - limits_.lower[i];
  const double to_upper = limits_.upper[i] - q[i];
  const double nearest = std::min(to_lower, to_upper);
  if (!(nearest < kNear)) return false;
  const double left = std::max(0.0, nearest);
  const double braking = std::sqrt(std::min(limits_.max_acceleration[i], 1e9) * left);
  limit.presence = fades_ ? 1.0 - left / kNear : 1.0;
  limit.speed = std::min(kApproach_per_s * left, braking) / (share * limit.presence);
  limit.sign = to_lower < to_upper ? 1.0 : -1.0;
  return fades_ || limit.speed < limits_.max_velocity[i];
}

void JointLimitRows::add(const JointVector& q, const TaskKinematics& kinematics,
                         const ScaledVector& inv_sqrt_weights, double share,
                         SpeedRows& rows) const noexcept {
  Limit limit;
  for (int i = 0; i < q.size(); ++i) {
    if (!find(q, i, share, limit)) continue;
    SpeedRow& row = rows.row[rows.size++];
    row.a_scaled.setZero();
    row.a_scaled[i] = limit.sign * kScaledLength;
    row.a_task = kinematics.pseudoinverse.project(row.a_scaled);
    row.v_max_m_per_s = kScaledLength / inv_sqrt_weights[i] * limit.speed;
    row.damping_N_s_per_m = kDamping_N_s_per_m;
    row.presence = limit.presence;
  }
}

bool JointLimitRows::isKept(const JointVector& q, const ScaledVector& velocity,
                            double share) const noexcept {
  Limit limit;
  for (int i = 0; i < q.size(); ++i)
    if (find(q, i, share, limit) && !(limit.sign * velocity[i] >= -limit.speed)) return false;
  return true;
}

}  // namespace tactus
