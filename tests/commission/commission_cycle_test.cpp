#include "tactus/commission/commission_cycle.h"

#include <gtest/gtest.h>

#include "support/commission_rig.h"

/// Whole arms, of which nobody knows how they are wired, turned and counted.
namespace tactus {
namespace {

using test::CommissionRig;
using test::HiddenJoint;
using test::Random;

/// Three drives a bus, as robot.yaml has them.
std::vector<HiddenJoint> plainArm(int joints) {
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

CommissionConfig configOf(const std::vector<HiddenJoint>& file) {
  CommissionConfig config;
  config.hardware = test::hardwareOf(file, file.back().bus + 2, true);
  for (const HiddenJoint& joint : file) config.is_prismatic.push_back(joint.is_prismatic);
  return config;
}

/// What the file does not know: everything but the kind of joint.
std::vector<HiddenJoint> hiddenArm(Random& random, const std::vector<HiddenJoint>& file) {
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

/// As good as the places that were measured: nowhere between the joint's ends is it further off
/// than twice the measuring error, or three times where one value of the file was confirmed.
void expectFound(const CommissionRig& rig, const JointFindings& found) {
  const HiddenJoint& truth = rig.truth[found.joint];
  const MotionBounds& bounds = rig.config.bounds(found.joint);
  EXPECT_EQ(found.bus, truth.bus);
  EXPECT_EQ(found.node_id, truth.node_id);
  EXPECT_EQ(found.scale.sign, truth.sign);
  EXPECT_NEAR(found.scale.counts_per_unit, truth.counts_per_unit,
              2.0 * found.scale.uncertainty * truth.counts_per_unit);
  ASSERT_TRUE(found.lower && found.upper);
  for (const double q : {*found.lower, *found.upper, truth.start}) {
    const double counts = truth.sign * truth.counts_per_unit * (q - truth.offset);
    EXPECT_NEAR(found.scale.position(counts), q, 3.0 * bounds.measuring_error);
  }
  // The ends were told a motion before the true ones, and the margin is kept.
  EXPECT_LT(*found.upper, truth.upper);
  EXPECT_GT(*found.upper, truth.upper - 2.5 * bounds.max_travel - 2.0 * bounds.margin);
  EXPECT_GT(*found.lower, truth.lower);
  EXPECT_NEAR(found.lag_s, 0.004, 0.003);
  EXPECT_LT(found.following_error, bounds.max_following_error);
  EXPECT_GT(found.acceleration, 0.5 * bounds.max_acceleration);
}

TEST(CommissionCycle, ScanNamesWhoAnswers) {
  std::vector<HiddenJoint> file = plainArm(4);
  std::vector<HiddenJoint> truth = file;
  truth[1].is_absent = true;
  truth[2].node_id = 90;
  CommissionRig rig(truth, configOf(file), 1);
  ASSERT_TRUE(rig.scan());
  std::vector<std::pair<int, int>> found;
  for (const FoundNode& node : rig.cycle->nodes()) {
    found.emplace_back(node.bus, node.node_id);
    EXPECT_TRUE(node.isDrive());
    EXPECT_EQ(node.vendor, 0x7acu);
    EXPECT_EQ(node.product, 1u);
    EXPECT_FALSE(node.counts_per_turn);
  }
  EXPECT_EQ(found, (std::vector<std::pair<int, int>>{{0, 1}, {0, 90}, {1, 1}}));
}

TEST(CommissionCycle, FindsAllOfHiddenArms) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const std::vector<HiddenJoint> file = plainArm(seed == 1 ? 16 : random.integer(2, 6));
    CommissionRig rig(hiddenArm(random, file), configOf(file), seed);
    ASSERT_TRUE(rig.scan());
    for (int joint = 0; joint < rig.config.joints(); ++joint) {
      SCOPED_TRACE(joint);
      ASSERT_TRUE(rig.commission(joint));
      const JointCommission& done = *rig.cycle->joint();
      ASSERT_EQ(done.trouble().kind, JointTroubleKind::kNone)
          << static_cast<int>(done.trouble().kind) << " " << faultName(done.trouble().stroke.fault)
          << " " << done.trouble().value << " " << done.trouble().limit;
      expectFound(rig, done.findings());
      EXPECT_TRUE(rig.isAllOffAndAtRest());
    }
    EXPECT_GT(rig.worst_speed, 0.7);  // the bounds are what holds motions back
    EXPECT_GT(rig.worst_travel, 0.7);
    EXPECT_LE(rig.worst_speed, 1.0 + 1e-3);
    EXPECT_LE(rig.worst_travel, 1.0 + 1e-3);
    EXPECT_EQ(rig.most_powered, 1);
  }
}

}  // namespace
}  // namespace tactus
