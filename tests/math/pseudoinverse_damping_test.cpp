#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "support/expanded_pseudoinverse.h"
#include "support/random_jacobian.h"
#include "support/random_robot.h"

namespace tactus {
namespace {

/// Gain of J# along one singular direction of size s, the others being 1.
double gainAlong(test::Random& random, double s) {
  const JointVector weights = JointVector::Ones(7);
  const TaskJacobian J = test::randomJacobian(random, {1.0, 1.0, s}, weights);
  const Eigen::MatrixXd J_sharp = test::expandPseudoinverse(J, weights).J_sharp;
  // |J#|_F^2 = g(1)^2 + g(1)^2 + g(s)^2; project on the direction that J maps weakest instead.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(J * J.transpose());
  return (J_sharp * solver.eigenvectors().col(0)).norm();
}

TEST(Damping, StaysOffAboveItsThreshold) {
  test::Random random(61);
  for (int i = 0; i < 200; ++i) {
    const double s = random.logUniform(0.02001, 0.9);
    EXPECT_NEAR(gainAlong(random, s) * s, 1.0, 1e-10) << s;
  }
}

TEST(Damping, StaysOffWhereItsCheapBoundCanNotTell) {
  // |R^-1|_F alone suspects three singular values of 0.021 to hide one below 0.02.
  test::Random random(65);
  const JointVector weights = test::randomWeights(random, 7);
  const TaskJacobian J = test::randomJacobian(random, {0.021, 0.021, 0.021}, weights);
  const auto inverse = test::expandPseudoinverse(J, weights);
  EXPECT_FALSE(inverse.factors.damped());
  EXPECT_EQ(inverse.factors.dampingSquared(), 0.0);
  EXPECT_LT((J * inverse.J_sharp - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(Damping, FollowsItsFormulaBelow) {
  test::Random random(62);
  for (int i = 0; i < 200; ++i) {
    const double s = random.uniform(1e-4, 0.01999);
    const double lambda_squared = 0.0025 * (1.0 - s * s / 0.0004);
    EXPECT_NEAR(gainAlong(random, s), s / (s * s + lambda_squared), 1e-7) << s;
  }
}

TEST(Damping, IsContinuousAcrossItsThreshold) {
  test::Random random(63);
  const double above = gainAlong(random, 0.02 * (1.0 + 1e-6));
  const double below = gainAlong(random, 0.02 * (1.0 - 1e-6));
  EXPECT_NEAR(above, below, 50.0 * 2e-5);
  EXPECT_NEAR(above, 50.0, 0.01);
}

TEST(Damping, BoundsTheGainOfEveryPose) {
  test::Random random(64);
  for (int i = 0; i < 400; ++i) {
    const int n = random.integer(2, kMaxJoints);
    const int m = random.integer(1, std::min(n, kMaxTaskSize));
    const JointVector weights = test::randomWeights(random, n);
    std::vector<double> spectrum(m);
    for (double& s : spectrum) s = random.chance(0.2) ? 0.0 : random.logUniform(1e-12, 10.0);
    const TaskJacobian J = test::randomJacobian(random, spectrum, weights);
    const Eigen::MatrixXd J_sharp = test::expandPseudoinverse(J, weights).J_sharp;
    ASSERT_TRUE(J_sharp.allFinite());
    // In W^1/2 coordinates, where singular values are measured; s / (s^2 + lambda^2) <= 1 / 0.02.
    const Eigen::MatrixXd scaled_inverse = weights.cwiseSqrt().asDiagonal() * J_sharp;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled_inverse.transpose() *
                                                                scaled_inverse);
    ASSERT_LE(std::sqrt(solver.eigenvalues().maxCoeff()), 50.0 * (1.0 + 1e-6));
  }
}

TEST(SmallestSingularValue, IsFoundWhateverTheWeights) {
  test::Random random(66);
  for (int i = 0; i < 200; ++i) {
    const JointVector weights = test::randomWeights(random, 7);
    const double s = random.logUniform(1e-6, 0.9);
    const TaskJacobian J = test::randomJacobian(random, {1.0, s, 0.95}, weights);
    EXPECT_NEAR(smallestSingularValue(J, weights), s, 2e-8 + 1e-12 / s);
  }
}

TEST(SmallestSingularValue, IsNothingWhereRankIsLost) {
  test::Random random(67);
  const JointVector weights = JointVector::Ones(7);
  const TaskJacobian J = test::randomJacobian(random, {1.0, 0.5, 0.0}, weights);
  EXPECT_NEAR(smallestSingularValue(J, weights), 0.0, 1e-7);
}

}  // namespace
}  // namespace tactus
