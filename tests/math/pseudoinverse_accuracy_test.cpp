#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "support/expanded_pseudoinverse.h"
#include "support/random_jacobian.h"
#include "support/random_robot.h"

/// Against a singular value decomposition in long double, down to singular value ratios of 1e-6.
namespace tactus {
namespace {

using test::LongMatrix;

constexpr double kErrorAllowed = 1e-10;

/// W^-1/2 V f(S) U^T w of J W^-1/2 = U S V^T.
template <typename Function>
LongMatrix oracle(const TaskJacobian& J, const JointVector& weights, Function f) {
  const LongMatrix inv_sqrt = weights.cast<long double>().cwiseSqrt().cwiseInverse();
  const LongMatrix scaled_J = J.cast<long double>() * inv_sqrt.col(0).asDiagonal();
  const Eigen::JacobiSVD<LongMatrix> svd(scaled_J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const LongMatrix gains =
      svd.singularValues().unaryExpr([&](long double s) { return static_cast<long double>(f(s)); });
  return inv_sqrt.col(0).asDiagonal() * svd.matrixV() * gains.col(0).asDiagonal() *
         svd.matrixU().transpose();
}

double error(const test::Matrix& J_sharp, const LongMatrix& exact) {
  return static_cast<double>((J_sharp.cast<long double>() - exact).norm() / exact.norm());
}

class PseudoinverseAccuracy : public testing::TestWithParam<int> {};

TEST_P(PseudoinverseAccuracy, IsThatOfTheSingularValueDecomposition) {
  test::Random random(40 + GetParam());
  double largest = 0.0;
  for (int i = 0; i < 60; ++i) {
    const int m = GetParam();
    const int n = random.integer(std::max(2, m), kMaxJoints);
    const JointVector weights = test::randomWeights(random, n);
    const double smallest = 0.021;  // just above the damping threshold
    const std::vector<double> spectrum = test::randomSpectrum(
        random, m, smallest, m > 1 ? smallest / random.logUniform(1e-6, 1.0) : smallest);
    const TaskJacobian J = test::randomJacobian(random, spectrum, weights);
    const test::ExpandedPseudoinverse ours = test::expandPseudoinverse(J, weights);
    ASSERT_FALSE(ours.factors.damped());
    largest = std::max(
        largest, error(ours.J_sharp, oracle(J, weights, [](long double s) { return 1.0L / s; })));
  }
  RecordProperty("largest_relative_error", std::to_string(largest));
  EXPECT_LT(largest, kErrorAllowed);
}

TEST_P(PseudoinverseAccuracy, ResidualDoesNotGrowWithTheConditionOfTheTask) {
  // J (J# w) = w to rounding of J times the length of J# w, whatever the singular values are.
  test::Random random(45 + GetParam());
  for (int i = 0; i < 200; ++i) {
    const int m = GetParam();
    const int n = random.integer(std::max(2, m), kMaxJoints);
    const JointVector weights = JointVector::Ones(n);
    const TaskJacobian J =
        test::randomJacobian(random, test::randomSpectrum(random, m, 0.021, 2.1e4), weights);
    const test::Matrix J_sharp = test::expandPseudoinverse(J, weights).J_sharp;
    const LongMatrix residual =
        J.cast<long double>() * J_sharp.cast<long double>() - LongMatrix::Identity(m, m);
    for (int column = 0; column < m; ++column)
      ASSERT_LT(residual.col(column).norm(), 4e-15L * J.norm() * J_sharp.col(column).norm());
  }
}

TEST_P(PseudoinverseAccuracy, DampedInverseIsThatOfTheDampedSingularValues) {
  test::Random random(50 + GetParam());
  for (int i = 0; i < 60; ++i) {
    const int m = GetParam();
    const int n = random.integer(std::max(2, m), kMaxJoints);
    const JointVector weights = test::randomWeights(random, n);
    const double smallest = random.logUniform(1e-9, 0.0199);
    const TaskJacobian J =
        test::randomJacobian(random, test::randomSpectrum(random, m, smallest, 2.0), weights);
    const test::ExpandedPseudoinverse ours = test::expandPseudoinverse(J, weights);
    const double s = smallest;
    const double lambda_squared = 0.05 * 0.05 * (1.0 - (s / 0.02) * (s / 0.02));
    ASSERT_TRUE(ours.factors.damped()) << "smallest singular value " << s;
    ASSERT_NEAR(ours.factors.dampingSquared(), lambda_squared, 1e-9);
    const LongMatrix exact = oracle(
        J, weights, [&](long double value) { return value / (value * value + lambda_squared); });
    ASSERT_LT(error(ours.J_sharp, exact), 1e-7) << "smallest singular value " << s;
  }
}

INSTANTIATE_TEST_SUITE_P(Components, PseudoinverseAccuracy, testing::Range(1, 7));

}  // namespace
}  // namespace tactus
