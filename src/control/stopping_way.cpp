#include "tactus/control/stopping_way.h"

#include <algorithm>
#include <cmath>

#include "tactus/math/pair.h"

namespace tactus {

StoppingWays::StoppingWays(const ControllerConfig& config, const std::vector<LinkCapsule>& capsules)
    : chain_(config.chain), q_measured_(config.q_start) {
  ChainPose pose;
  chain_.computePose(q_measured_, pose);
  for (int i = 0; i < chain_.size(); ++i) {
    inv_acceleration_[i] = 1.0 / config.limits.max_acceleration[i];
    turns_[i] = chain_.type(i) == JointType::kRevolute ? 1.0 : 0.0;
    if (i + 1 < chain_.size())
      to_next_m_[i] = (pose.p_BaseJoint[i + 1] - pose.p_BaseJoint[i]).norm();
  }
  for (const LinkCapsule& capsule : capsules) {
    if (capsule.link.joint < 0) continue;
    const Pose& X = capsule.link.X_JointFrame;
    double& furthest_m = own_m_[capsule.link.joint];
    for (const Vector3& p_Link : {capsule.p_LinkFrom, capsule.p_LinkTo})
      furthest_m = std::max(furthest_m, (X.p_AB + X.R_AB * p_Link).norm());
  }
  bool turns_before = false;
  for (int i = 0; i < chain_.size(); ++i) {
    lengthens_ = lengthens_ || (turns_before && turns_[i] == 0.0);
    turns_before = turns_before || turns_[i] == 1.0;
  }
  lever_m_ = levers_m(q_measured_, JointVector::Zero(chain_.size()), 0.0);
}

double StoppingWays::ramp_s(const JointVector& velocity) const noexcept {
  const int joints = chain_.size();
  Pair ramps_s = {0.0, 0.0};
  int i = 0;
  for (; i + 1 < joints; i += 2)
    ramps_s =
        larger(ramps_s, magnitude(pairAt(velocity.data() + i)) * pairAt(&inv_acceleration_[i]));
  const double ramp_s = std::max(ramps_s[0], ramps_s[1]);
  return i == joints ? ramp_s : std::max(ramp_s, std::abs(velocity[i]) * inv_acceleration_[i]);
}

StoppingWays::PerJoint StoppingWays::levers_m(const JointVector& q, const JointVector& velocity,
                                              double time_s) const noexcept {
  PerJoint levers_m;
  double reach_m = 0.0;
  for (int i = chain_.size() - 1; i >= 0; --i) {
    reach_m = std::max(own_m_[i], to_next_m_[i] + reach_m);
    levers_m[i] = turns_[i] == 1.0 ? reach_m : 1.0;
    if (turns_[i] == 0.0)
      reach_m += std::abs(q[i] - q_measured_[i]) + time_s * std::abs(velocity[i]);
  }
  return levers_m;
}

SpeedSums StoppingWays::speedSums(const JointVector& q,
                                  const ScaledVector& velocity) const noexcept {
  const int joints = chain_.size();
  PerJoint changed_m;
  if (lengthens_) changed_m = levers_m(q, velocity.head(joints), 0.0);
  const double* const lever_m = lengthens_ ? changed_m.data() : lever_m_.data();
  SpeedSums sums;
  sums[0] = 0.0;
  for (int i = 0; i < joints; ++i) sums[i + 1] = sums[i] + std::abs(velocity[i]) * lever_m[i];
  return sums;
}

StoppingWay StoppingWays::of(const JointVector& q, const JointVector& velocity,
                             double period_s) const noexcept {
  StoppingWay way;
  const double cycles = ramp_s(velocity) / period_s;
  const auto whole = static_cast<double>(static_cast<long long>(cycles));
  way.time_s = cycles < 1.0 ? period_s : period_s * (whole + 1.0) * (1.0 - 0.5 * whole / cycles);
  PerJoint changed_m;
  if (lengthens_) changed_m = levers_m(q, velocity, way.time_s);
  const double* const lever_m = lengthens_ ? changed_m.data() : lever_m_.data();
  double turning_rad_per_s = 0.0;
  for (int i = 0; i < chain_.size(); ++i) {
    const double speed = std::abs(velocity.data()[i]);
    const double turning = turns_[i] * speed;
    way.speed_m_per_s += speed * lever_m[i];
    way.acceleration_m_per_s2 += speed * lever_m[i] * (turning + 2.0 * turning_rad_per_s);
    turning_rad_per_s += turning;
  }
  return way;
}

}  // namespace tactus
