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

void JointLimitRows::add(const JointVector& q, const TaskKinematics& kinematics,
                         const ScaledVector& inv_sqrt_weights, double share,
                         SpeedRows& rows) const noexcept {
  for (int i = 0; i < q.size() && rows.size < kMaxRows; ++i) {
    const double to_lower = q[i] - limits_.lower[i];
    const double to_upper = limits_.upper[i] - q[i];
    const double left = std::max(0.0, std::min(to_lower, to_upper));
    const double braking = std::sqrt(std::min(limits_.max_acceleration[i], 1e9) * left);
    if (!(left < kNear)) continue;
    const double presence = fades_ ? 1.0 - left / kNear : 1.0;
    const double speed = std::min(kApproach_per_s * left, braking) / (share * presence);
    if (!(speed < limits_.max_velocity[i])) continue;
    SpeedRow& row = rows.row[rows.size++];
    row.a_scaled.setZero();
    row.a_scaled[i] = to_lower < to_upper ? kScaledLength : -kScaledLength;
    row.a_task = kinematics.pseudoinverse.project(row.a_scaled);
    row.v_max_m_per_s = kScaledLength / inv_sqrt_weights[i] * speed;
    row.damping_N_s_per_m = kDamping_N_s_per_m;
    row.presence = presence;
  }
}

}  // namespace tactus
