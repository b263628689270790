#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "support/kdl_chain.h"
#include "support/random_robot.h"
#include "tactus/math/serial_chain.h"

namespace tactus {
namespace {

constexpr double kAgreement = 1e-12;

TEST(ForwardKinematics, AgreesWithOrocosKdlOnRandomChains) {
  test::Random random(11);
  for (int i = 0; i < 600; ++i) {
    const int n = random.integer(2, kMaxJoints);
    const std::vector<Joint> joints = test::randomJoints(random, n);
    const AttachedFrame tip = test::randomFrame(random, random.integer(0, n - 1));
    const SerialChain chain(joints, tip);
    const JointVector q = random.vector(n, -7.0, 7.0);
    ChainPose pose;
    chain.computePose(q, pose);
    const Pose ours = framePose(pose, tip);
    const Pose kdl = test::kdlPose(joints, tip, q);
    ASSERT_TRUE(ours.R_AB.isApprox(kdl.R_AB, kAgreement)) << "chain " << i;
    ASSERT_LT((ours.p_AB - kdl.p_AB).norm(), kAgreement) << "chain " << i;
    ASSERT_EQ(framePosition(pose, tip), ours.p_AB);
  }
}

TEST(ForwardKinematics, LeavesRotationsOrthonormalAfterSixteenJoints) {
  test::Random random(12);
  for (int i = 0; i < 200; ++i) {
    const SerialChain chain = test::randomChain(random, kMaxJoints);
    ChainPose pose;
    chain.computePose(random.vector(kMaxJoints, -50.0, 50.0), pose);
    for (const Matrix3& R : pose.R_BaseJoint)
      ASSERT_LT((R * R.transpose() - Matrix3::Identity()).norm(), 1e-12);
  }
}

TEST(ForwardKinematics, AgreesWithOrocosKdlOnManyParallelAxes) {
  // Rounding errors of one joint must not be multiplied by the next: with a general axis shared by
  // sixteen joints they could grow fivefold a joint.
  test::Random random(16);
  for (int i = 0; i < 200; ++i) {
    const Vector3 axis = random.unitVector();
    std::vector<Joint> joints(kMaxJoints);
    for (Joint& joint : joints) {
      joint.axis = axis;
      joint.X_ParentJoint.p_AB = Vector3(0.2, 0.0, 0.0);
    }
    const AttachedFrame tip{kMaxJoints - 1, {}};
    const JointVector q = i % 2 == 0 ? JointVector(JointVector::Constant(kMaxJoints, M_PI))
                                     : random.vector(kMaxJoints, -3.1, 3.1);
    ChainPose pose;
    SerialChain(joints, tip).computePose(q, pose);
    ASSERT_LT((framePosition(pose, tip) - test::kdlPose(joints, tip, q).p_AB).norm(), kAgreement);
    const Matrix3& R = pose.R_BaseJoint[kMaxJoints - 1];
    ASSERT_LT((R * R.transpose() - Matrix3::Identity()).norm(), 1e-13);
  }
}

TEST(ForwardKinematics, KeepsFramesOfTheBaseInPlace) {
  test::Random random(13);
  const SerialChain chain = test::randomChain(random, 3);
  const AttachedFrame fixed = test::randomFrame(random, -1);
  ChainPose pose;
  chain.computePose(random.vector(3, -1.0, 1.0), pose);
  EXPECT_EQ(framePose(pose, fixed).p_AB, fixed.X_JointFrame.p_AB);
  EXPECT_EQ(framePosition(pose, fixed), fixed.X_JointFrame.p_AB);
}

TEST(ForwardKinematics, PassesNoNumberOn) {
  test::Random random(14);
  std::vector<Joint> joints = test::randomJoints(random, 4);
  for (Joint& joint : joints) joint.type = JointType::kRevolute;
  const SerialChain chain(joints, test::randomFrame(random, 3));
  JointVector q = JointVector::Zero(4);
  q[1] = std::numeric_limits<double>::quiet_NaN();
  ChainPose pose;
  chain.computePose(q, pose);
  EXPECT_FALSE(framePose(pose, chain.tip()).p_AB.allFinite());
}

TEST(ForwardKinematics, RefusesChainsThatAreNone) {
  test::Random random(15);
  const std::vector<Joint> good = test::randomJoints(random, 4);
  const AttachedFrame tip = test::randomFrame(random, 3);
  EXPECT_NO_THROW(SerialChain(good, tip));
  EXPECT_THROW(SerialChain({good[0]}, {0, {}}), std::invalid_argument);
  EXPECT_THROW(SerialChain(test::randomJoints(random, 17), tip), std::invalid_argument);
  EXPECT_THROW(SerialChain(good, {4, {}}), std::invalid_argument);
  EXPECT_THROW(SerialChain(good, {-2, {}}), std::invalid_argument);
  const auto refuses = [&](auto change) {
    std::vector<Joint> joints = good;
    change(joints[2]);
    EXPECT_THROW(SerialChain(joints, tip), std::invalid_argument);
  };
  refuses([](Joint& joint) { joint.axis.setZero(); });
  refuses([](Joint& joint) { joint.axis *= 2.0; });
  refuses([](Joint& joint) { joint.axis[1] = std::numeric_limits<double>::quiet_NaN(); });
  refuses(
      [](Joint& joint) { joint.X_ParentJoint.p_AB[2] = std::numeric_limits<double>::infinity(); });
  refuses([](Joint& joint) { joint.X_ParentJoint.R_AB *= 1.001; });
  refuses([](Joint& joint) { joint.X_ParentJoint.R_AB.col(0) *= -1.0; });
  refuses([](Joint& joint) {
    joint.X_ParentJoint.R_AB(0, 0) = std::numeric_limits<double>::quiet_NaN();
  });
}

}  // namespace
}  // namespace tactus
