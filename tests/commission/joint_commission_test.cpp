#include "tactus/commission/joint_commission.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "support/commission_arms.h"

/// One joint between questions and motions, without a cycle.
namespace tactus {
namespace {

using test::Random;
using Kind = Answer::Kind;

Answer anyAnswer(Random& random, const Question& question, int joints) {
  const auto oneOf = [&](std::vector<Kind> kinds) {
    return Answer{kinds[static_cast<std::size_t>(random.index(static_cast<int>(kinds.size())))]};
  };
  switch (question.asked) {
    case Asked::kReady:
      return {Kind::kYes};
    case Asked::kDirection:
      if (random.chance(0.3)) return {Kind::kOtherJoint, 0.0, random.index(joints)};
      return oneOf({Kind::kPlus, Kind::kMinus, Kind::kNothing, Kind::kNothing});
    case Asked::kJog:
      return oneOf({Kind::kPlus, Kind::kMinus, Kind::kUpper, Kind::kLower, Kind::kDone});
    case Asked::kEndPlace:
      if (random.chance(0.5)) return {Kind::kUnknown};
      break;
    case Asked::kPlace:
      break;
  }
  return {Kind::kNumber, random.uniform(-1.0, 1.0) * random.logUniform(1e-4, 10.0)};
}

/// The drive does what it is told.
StrokeReport reportOf(const StrokePlan& plan, double start_counts) {
  StrokeReport report;
  report.end = StrokeEnd::kDone;
  report.has_moved = report.is_seen_off = true;
  report.start_counts = report.end_counts = start_counts;
  if (plan.shape.kind == StrokeShape::Kind::kStep)
    report.end_counts += std::round(plan.shape.distance * plan.bounds.counts_per_unit);
  return report;
}

struct Growth {
  std::map<std::pair<int, int>, std::pair<double, double>> last;  ///< by drive: travel, speed
  int motions = 0;
  double most = 0.0;

  void add(const StrokePlan& plan) {
    const double unit = plan.bounds.counts_per_unit;
    const std::pair now{unit * plan.bounds.max_travel, unit * plan.bounds.limits.max_speed};
    EXPECT_LE(std::abs(plan.shape.distance), plan.bounds.max_travel * (1.0 + 1e-12));
    const auto [entry, is_new] = last.try_emplace({plan.bus, plan.node_id}, now);
    most = std::max({most, now.first / entry->second.first, now.second / entry->second.second});
    entry->second = now;
    motions += is_new ? 0 : 1;
  }
};

/// A drive may turn out to be that of another joint, whose velocities have another unit.
TEST(JointCommission, AtThePlaceOfAnotherJointTheUnitOfVelocitiesIsLookedAt) {
  CommissionConfig config = test::commissionConfig(test::plainArm(3));
  config.hardware.drives[1].has_velocity_unit = false;
  config.hardware.drives[1].product_code = 7;
  config.hardware.drives[2].has_quick_stop_option = false;
  config.hardware.drives[2].has_speed_limit = false;
  const NodeUses uses(config, {{0, 2, 402, {}, {}, {}, {}}, {0, 3, 402, {}, {}, {}, {}}});
  const DriveConfig own = uses.entryFor(1, uses.nodes()[0]);
  EXPECT_FALSE(own.has_velocity_unit);
  EXPECT_TRUE(own.has_quick_stop_option && own.has_speed_limit);
  const DriveConfig others = uses.entryFor(1, uses.nodes()[1]);
  EXPECT_TRUE(others.has_velocity_unit);
  EXPECT_FALSE(others.has_quick_stop_option || others.has_speed_limit);
  EXPECT_EQ(others.product_code, 7u);
}

/// Joints of which some have few counts hold the motions of all back, until an answer says that
/// it is none of them.
TEST(JointCommission, WhateverIsAnsweredNoMotionIsLongerThanThreeTimesTheLast) {
  Growth growth;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Random random(seed);
    std::vector<test::HiddenJoint> file = test::plainArm(4);
    for (test::HiddenJoint& joint : file) joint.counts_per_unit *= random.logUniform(0.01, 100.0);
    const CommissionConfig config = test::commissionConfig(file);
    std::vector<FoundNode> nodes;
    for (const test::HiddenJoint& joint : file)
      nodes.push_back({joint.bus, joint.node_id, 402, {}, {}, {}, {}});
    NodeUses uses(config, nodes);
    growth.last.clear();
    for (int run = 0; run < 6; ++run) {
      JointCommission joint(config, random.index(4), uses);
      double counts = 0.0;
      for (int i = 0; i < 60 && !joint.isFinished(); ++i) {
        if (const Question* const question = joint.question()) {
          const Answer answer = anyAnswer(random, *question, 4);
          if (joint.isAnswer(answer)) joint.take(answer, counts);
          continue;
        }
        const StrokePlan plan = joint.stroke();
        growth.add(plan);
        const StrokeReport report = reportOf(plan, counts);
        counts = report.end_counts;
        joint.onStroke(report);
      }
    }
  }
  EXPECT_LE(growth.most, 3.0 + 1e-9);
  EXPECT_GT(growth.most, 2.9);
  EXPECT_GT(growth.motions, 1000);
}

}  // namespace
}  // namespace tactus
