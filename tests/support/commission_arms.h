#pragma once

#include <utility>
#include <vector>

#include "support/commission_rig.h"

namespace tactus::test {

/// Three drives a bus, as robot.yaml has them.
inline std::vector<HiddenJoint> plainArm(int joints) {
  std::vector<HiddenJoint> arm(static_cast<std::size_t>(joints));
  for (int j = 0; j < joints; ++j) {
    arm[j].bus = j / 3;
    arm[j].node_id = 1 + j % 3;
    arm[j].is_prismatic = j == 0;
    arm[j].counts_per_unit = arm[j].is_prismatic ? 1e7 : 1e6;
    arm[j].lower = arm[j].is_prismatic ? -0.1 : -0.4;
    arm[j].upper = -arm[j].lower;
  }
  return arm;
}

inline CommissionConfig commissionConfig(const std::vector<HiddenJoint>& file) {
  CommissionConfig config;
  config.hardware = hardwareOf(file, file.back().bus + 2, true);
  for (const HiddenJoint& joint : file) config.is_prismatic.push_back(joint.is_prismatic);
  return config;
}

/// What the file does not know: everything but the kind of joint.
inline std::vector<HiddenJoint> hiddenArm(Random& random, const std::vector<HiddenJoint>& file) {
  std::vector<HiddenJoint> arm = file;
  for (HiddenJoint& joint : arm) {
    joint.sign = random.chance(0.5) ? 1 : -1;
    if (random.chance(0.7)) joint.counts_per_unit *= random.logUniform(0.12, 8.0);
    joint.offset = random.uniform(-3.0, 3.0);
    joint.start = random.uniform(-0.3, 0.3) * joint.upper;
  }
  const auto swapPlaces = [](HiddenJoint& a, HiddenJoint& b) {
    std::swap(a.bus, b.bus);
    std::swap(a.node_id, b.node_id);
  };
  const int joints = static_cast<int>(arm.size());
  for (int i = 0; i < joints; ++i)
    if (random.chance(0.2)) swapPlaces(arm[i], arm[random.index(joints)]);
  if (random.chance(0.3)) arm[random.index(joints)].node_id = 77;  // on a bus where it is free
  return arm;
}

/// As good as the places that were measured, between the joint's ends if those were told: there it
/// is no further off than three times the measuring error.
inline void expectFound(const CommissionRig& rig, const JointFindings& found) {
  const HiddenJoint& truth = rig.truth[found.joint];
  const MotionBounds& bounds = rig.config.bounds(found.joint);
  EXPECT_EQ(found.bus, truth.bus);
  EXPECT_EQ(found.node_id, truth.node_id);
  EXPECT_EQ(found.scale.sign, truth.sign);
  EXPECT_GT(found.scale.uncertainty, 0.0);
  EXPECT_LT(found.scale.uncertainty, 0.1);
  EXPECT_NEAR(found.scale.counts_per_unit, truth.counts_per_unit,
              2.0 * found.scale.uncertainty * truth.counts_per_unit);
  EXPECT_EQ(found.lower.has_value(), rig.jogs);
  EXPECT_EQ(found.upper.has_value(), rig.jogs);
  for (const double q : {found.lower.value_or(truth.start), found.upper.value_or(truth.start)}) {
    const double counts = truth.sign * truth.counts_per_unit * (q - truth.offset);
    EXPECT_NEAR(found.scale.position(counts), q, 3.0 * bounds.measuring_error);
  }
  if (rig.jogs) {  // the ends were told a motion before the true ones, and the margin is kept
    const double near = 2.5 * bounds.max_travel + 2.0 * bounds.margin;
    EXPECT_LT(*found.upper, truth.upper);
    EXPECT_GT(*found.upper, truth.upper - near);
    EXPECT_GT(*found.lower, truth.lower);
    EXPECT_LT(*found.lower, truth.lower + near);
  }
  EXPECT_NEAR(found.lag_s, 0.004, 0.003);
  EXPECT_LT(found.following_error, bounds.max_following_error);
  EXPECT_GT(found.acceleration, 0.5 * bounds.max_acceleration);
}

}  // namespace tactus::test
