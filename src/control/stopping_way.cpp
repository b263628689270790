#include "tactus/control/stopping_way.h"

#include <algorithm>
#include <cmath>

namespace tactus {

StoppingWays::StoppingWays(const ControllerConfig& config, const std::vector<LinkCapsule>& capsules)
    : chain_(config.chain),
      q_measured_(config.q_start),
      inv_acceleration_(config.limits.max_acceleration.cwiseInverse()) {
  ChainPose pose;
  chain_.computePose(q_measured_, pose);
  for (int i = 0; i + 1 < chain_.size(); ++i)
    to_next_m_[i] = (pose.p_BaseJoint[i + 1] - pose.p_BaseJoint[i]).norm();
  for (const LinkCapsule& capsule : capsules) {
    if (capsule.link.joint < 0) continue;
    const Pose& X = capsule.link.X_JointFrame;
    double& furthest_m = own_m_[capsule.link.joint];
    for (const Vector3& p_Link : {capsule.p_LinkFrom, capsule.p_LinkTo})
      furthest_m = std::max(furthest_m, (X.p_AB + X.R_AB * p_Link).norm());
  }
}

double StoppingWays::ramp_s(const JointVector& velocity) const noexcept {
  double ramp_s = 0.0;
  for (int i = 0; i < chain_.size(); ++i)
    ramp_s = std::max(ramp_s, std::abs(velocity[i]) * inv_acceleration_[i]);
  return ramp_s;
}

StoppingWay StoppingWays::of(const JointVector& q, const JointVector& velocity,
                             double period_s) const noexcept {
  StoppingWay way;
  const double cycles = ramp_s(velocity) / period_s;
  const double whole = std::floor(cycles);
  way.time_s = cycles < 1.0 ? period_s : period_s * (whole + 1.0) * (1.0 - 0.5 * whole / cycles);
  std::array<double, kMaxJoints> lever_m;
  double reach_m = 0.0;
  for (int i = chain_.size() - 1; i >= 0; --i) {
    reach_m = std::max(own_m_[i], to_next_m_[i] + reach_m);
    const bool is_prismatic = chain_.type(i) == JointType::kPrismatic;
    lever_m[i] = is_prismatic ? 1.0 : reach_m;
    if (is_prismatic)
      reach_m += std::abs(q[i] - q_measured_[i]) + way.time_s * std::abs(velocity[i]);
  }
  double turning_rad_per_s = 0.0;
  for (int i = 0; i < chain_.size(); ++i) {
    const double speed = std::abs(velocity[i]);
    const bool turns = chain_.type(i) == JointType::kRevolute;
    way.speed_m_per_s += speed * lever_m[i];
    way.acceleration_m_per_s2 +=
        speed * lever_m[i] * ((turns ? speed : 0.0) + 2.0 * turning_rad_per_s);
    if (turns) turning_rad_per_s += speed;
  }
  return way;
}

}  // namespace tactus
