#include "tactus/commission/commission_cycle.h"

#include <gtest/gtest.h>

#include "support/commission_arms.h"

/// Whole arms, of which nobody knows how they are wired, turned and counted.
namespace tactus {
namespace {

using test::CommissionRig;
using test::HiddenJoint;
using test::plainArm;
using test::Random;

TEST(CommissionCycle, ScanNamesWhoAnswers) {
  std::vector<HiddenJoint> file = plainArm(4);
  std::vector<HiddenJoint> truth = file;
  truth[1].is_absent = true;
  truth[2].node_id = 90;
  CommissionRig rig(truth, test::commissionConfig(file), 1);
  ASSERT_TRUE(rig.scan());
  std::vector<std::pair<int, int>> found;
  for (const FoundNode& node : rig.cycle->nodes()) {
    found.emplace_back(node.bus, node.node_id);
    EXPECT_TRUE(node.isDrive());
    EXPECT_EQ(node.vendor, 0x7acu);
    EXPECT_EQ(node.product, 1u);
    EXPECT_FALSE(node.counts_per_turn);
    EXPECT_TRUE(node.has_speed_limit);
  }
  EXPECT_EQ(found, (std::vector<std::pair<int, int>>{{0, 1}, {0, 90}, {1, 1}}));
}

TEST(CommissionCycle, FindsAllOfHiddenArms) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const std::vector<HiddenJoint> file = plainArm(seed == 1 ? 16 : random.integer(2, 6));
    CommissionRig rig(test::hiddenArm(random, file), test::commissionConfig(file), seed);
    ASSERT_TRUE(rig.scan());
    for (int joint = 0; joint < rig.config.joints(); ++joint) {
      SCOPED_TRACE(joint);
      ASSERT_TRUE(rig.commission(joint));
      const JointCommission& done = *rig.cycle->joint();
      ASSERT_EQ(done.trouble().kind, JointTroubleKind::kNone)
          << static_cast<int>(done.trouble().kind) << " " << faultName(done.trouble().stroke.fault)
          << " " << done.trouble().value << " " << done.trouble().limit;
      test::expectFound(rig, done.findings());
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
