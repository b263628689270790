#include "tactus/analysis/cover_geometry.h"

#include <gtest/gtest.h>

#include "support/crops9.h"
#include "support/random.h"
#include "support/random_robot.h"

namespace tactus {
namespace {

using test::Random;

ChainPose poseAt(const SerialChain& chain, const JointVector& q) {
  ChainPose pose;
  chain.computePose(q, pose);
  return pose;
}

/// The cover of crops9 around link 4, which is 0.38 m long along x, turned about its start.
double shareTurned(const JointVector& q, const Matrix3& turn, double start_m = 0.0) {
  ControllerConfig config = test::crops9Controller(Variant::kNullSpace);
  TactileModuleConfig& module = config.tactile_modules.front();
  module.link.X_JointFrame = {turn, Vector3(start_m, 0.0, 0.0)};
  return shareOffLink(config.chain, poseAt(config.chain, q), module);
}

Matrix3 turn(double angle_rad, const Vector3& axis) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

TEST(CoverGeometry, HasBothEndsOfTheCover) {
  Random random(21);
  const ControllerConfig config = test::crops9Controller(Variant::kNullSpace);
  for (int i = 0; i < 20; ++i) {
    const ChainPose pose = poseAt(config.chain, random.vector(9, -1.0, 1.0));
    const CoverEnds ends = coverEnds(pose, config.tactile_modules.front());
    EXPECT_LT((ends.p_BaseStart - pose.p_BaseJoint[3]).norm(), 1e-12);
    EXPECT_LT((ends.p_BaseEnd - pose.p_BaseJoint[4]).norm(), 1e-12) << "the link is as long";
  }
}

TEST(CoverGeometry, TellsACoverAlongItsLinkFromOneAcross) {
  Random random(22);
  for (int i = 0; i < 50; ++i) {
    const JointVector q = random.vector(9, -1.0, 1.0);
    const Vector3 across(0.0, random.uniform(-1.0, 1.0), 1.0);
    const double angle_rad = random.uniform(0.0, 1.5);
    EXPECT_NEAR(shareTurned(q, turn(angle_rad, across.normalized())), std::sin(angle_rad), 1e-9);
    EXPECT_NEAR(shareTurned(q, turn(3.14159, Vector3::UnitZ())), 1.0, 1e-3) << "backwards";
    EXPECT_NEAR(shareTurned(q, turn(3.14159, Vector3::UnitZ()), 0.38), 0.0, 1e-3)
        << "from the link's end to its start";
  }
}

TEST(CoverGeometry, MeasuresLinksWhereverTheJointsAre) {
  Random random(23);
  const ControllerConfig config = test::crops9Controller();
  for (int i = 0; i < 20; ++i) {
    const ArmLengths lengths =
        armLengths(config.chain, poseAt(config.chain, random.vector(9, -1.0, 1.0)));
    EXPECT_NEAR(lengths.longest_m, 0.38, 1e-12);
    EXPECT_EQ(lengths.longest_joint, 3);
    EXPECT_NEAR(lengths.all_m, 0.1 + 0.12 + 0.23 + 0.38 + 0.12 + 0.18 + 0.15 + 0.12 + 0.15, 1e-12);
  }
}

}  // namespace
}  // namespace tactus
