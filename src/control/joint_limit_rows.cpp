#include "tactus/control/joint_limit_rows.h"

#include <algorithm>

namespace tactus {
namespace {

constexpr double kApproach_per_s = 5.0;  ///< gamma
constexpr double kLever_m = 0.3;
/// A limit does not yield to what presses against the arm.
constexpr double kDamping_N_s_per_m = 2e6;

}  // namespace

JointLimitRows::JointLimitRows(const JointLimits& limits, const SerialChain& chain)
    : limits_(limits), lever_m_(JointVector::Constant(chain.size(), kLever_m)) {
  for (int i = 0; i < chain.size(); ++i)
    if (chain.type(i) == JointType::kPrismatic) lever_m_[i] = 1.0;
}

void JointLimitRows::add(const JointVector& q, const TaskKinematics& kinematics,
                         const ScaledVector& inv_sqrt_weights, SpeedRows& rows) const noexcept {
  for (int i = 0; i < q.size() && rows.size < kMaxRows; ++i) {
    const double to_lower = q[i] - limits_.lower[i];
    const double to_upper = limits_.upper[i] - q[i];
    const double left = std::max(0.0, std::min(to_lower, to_upper));
    if (kApproach_per_s * left >= limits_.max_velocity[i]) continue;
    SpeedRow& row = rows.row[rows.size++];
    row.a_scaled.setZero();
    row.a_scaled[i] = (to_lower < to_upper ? lever_m_[i] : -lever_m_[i]) * inv_sqrt_weights[i];
    row.a_task = kinematics.pseudoinverse.project(row.a_scaled);
    row.v_max_m_per_s = lever_m_[i] * kApproach_per_s * left;
    row.damping_N_s_per_m = kDamping_N_s_per_m;
  }
}

}  // namespace tactus
