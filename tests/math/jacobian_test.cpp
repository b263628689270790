#include <gtest/gtest.h>

#include "support/expanded_pseudoinverse.h"
#include "support/kdl_chain.h"
#include "support/random_robot.h"

namespace tactus {
namespace {

constexpr double kJacobianAgreement = 1e-12;
constexpr double kStep = 1e-6;  // of central differences, whose error is then some 1e-10
constexpr double kDifferenceTolerance = 2e-8;
constexpr int kAll[6] = {0, 1, 2, 3, 4, 5};

struct JacobianCase {
  explicit JacobianCase(test::Random& random)
      : n(random.integer(2, kMaxJoints)),
        joints(test::randomJoints(random, n)),
        frame(test::randomFrame(random, random.integer(0, n - 1))),
        q(random.vector(n, -4.0, 4.0)) {}

  Pose poseAt(const JointVector& at) const {
    ChainPose pose;
    SerialChain(joints, frame).computePose(at, pose);
    return framePose(pose, frame);
  }

  /// (f_position, f_orientation)^T J column by column, from poses alone.
  double centralDifference(int joint, int component) const {
    JointVector before = q;
    JointVector after = q;
    before[joint] -= kStep;
    after[joint] += kStep;
    const Pose X_before = poseAt(before);
    const Pose X_after = poseAt(after);
    if (component < 3) return (X_after.p_AB - X_before.p_AB)[component] / (2.0 * kStep);
    const Matrix3 turn = X_after.R_AB * X_before.R_AB.transpose();
    const Vector3 axis(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
    return 0.5 * axis[component - 3] / (2.0 * kStep);
  }

  int n;
  std::vector<Joint> joints;
  AttachedFrame frame;
  JointVector q;
};

TEST(TipJacobian, AgreesWithOrocosKdlOnRandomChains) {
  test::Random random(21);
  for (int i = 0; i < 600; ++i) {
    const JacobianCase c(random);
    const TaskJacobian J = test::tipJacobian(SerialChain(c.joints, c.frame), c.q, kAll, 6);
    const Eigen::MatrixXd kdl = test::kdlJacobian(c.joints, c.frame, c.q);
    const int moving = c.frame.joint + 1;
    ASSERT_EQ(J.cols(), c.n);
    ASSERT_LT((J.leftCols(moving) - kdl).cwiseAbs().maxCoeff(), kJacobianAgreement)
        << "chain " << i;
    ASSERT_TRUE((J.rightCols(c.n - moving).array() == 0.0).all()) << "joints beyond the tip";
  }
}

TEST(TipJacobian, AgreesWithCentralDifferences) {
  test::Random random(22);
  for (int i = 0; i < 60; ++i) {
    const JacobianCase c(random);
    const TaskJacobian J = test::tipJacobian(SerialChain(c.joints, c.frame), c.q, kAll, 6);
    for (int joint = 0; joint < c.n; ++joint)
      for (int component = 0; component < 6; ++component)
        ASSERT_NEAR(J(component, joint), c.centralDifference(joint, component),
                    kDifferenceTolerance);
  }
}

TEST(TipJacobian, DeliversTheComponentsAskedForInTheirOrder) {
  test::Random random(23);
  for (int i = 0; i < 100; ++i) {
    const JacobianCase c(random);
    const SerialChain chain(c.joints, c.frame);
    const TaskJacobian all = test::tipJacobian(chain, c.q, kAll, 6);
    const auto components = test::randomComponents(random);
    const int count = random.integer(1, 6);
    const TaskJacobian some = test::tipJacobian(chain, c.q, components.data(), count);
    ASSERT_EQ(some.rows(), count);
    for (int row = 0; row < count; ++row)
      ASSERT_EQ(Eigen::VectorXd(some.row(row)), Eigen::VectorXd(all.row(components[row])));
  }
}

TEST(PointJacobianTranspose, AgreesWithOrocosKdlForAPointOnAnyLink) {
  test::Random random(24);
  for (int i = 0; i < 600; ++i) {
    const JacobianCase c(random);
    const SerialChain chain(c.joints, test::randomFrame(random, c.n - 1));
    ChainPose pose;
    chain.computePose(c.q, pose);
    const Vector3 f = random.unitVector();
    ScaledVector a;
    applyPointJacobianTranspose(chain, pose, c.frame.joint, framePosition(pose, c.frame), f, a);
    const int moving = c.frame.joint + 1;
    const Eigen::MatrixXd J_p = test::kdlJacobian(c.joints, c.frame, c.q).topRows(3);
    ASSERT_LT((a.head(moving) - J_p.transpose() * f).cwiseAbs().maxCoeff(), kJacobianAgreement);
    ASSERT_TRUE((a.tail(kMaxJoints - moving).array() == 0.0).all()) << "joints beyond the link";
  }
}

TEST(PointJacobianTranspose, IsZeroForAPointOfTheBase) {
  test::Random random(25);
  const JacobianCase c(random);
  const SerialChain chain(c.joints, c.frame);
  ChainPose pose;
  chain.computePose(c.q, pose);
  ScaledVector a;
  applyPointJacobianTranspose(chain, pose, -1, Vector3::Ones(), Vector3::UnitX(), a);
  EXPECT_EQ(a, ScaledVector(ScaledVector::Zero()));
}

}  // namespace
}  // namespace tactus
