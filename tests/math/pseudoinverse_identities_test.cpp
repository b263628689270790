#include <gtest/gtest.h>

#include "support/expanded_pseudoinverse.h"
#include "support/random_jacobian.h"
#include "support/random_robot.h"

/// What makes J# the weighted pseudoinverse and N its projector, without any other implementation.
namespace tactus {
namespace {

using test::Matrix;

constexpr double kTolerance = 1e-11;

double relative(const Matrix& difference, const Matrix& scale) {
  return difference.norm() / scale.norm();
}

double asymmetry(const Matrix& A) { return relative(A - A.transpose(), A); }

struct IdentityCase {
  explicit IdentityCase(test::Random& random)
      : n(random.integer(2, kMaxJoints)),
        m(random.integer(1, std::min(n, kMaxTaskSize))),
        weights(test::randomWeights(random, n)),
        J(test::randomJacobian(random, test::randomSpectrum(random, m, 0.05, 20.0), weights)),
        W(Matrix(weights.asDiagonal())),
        inverse(test::expandPseudoinverse(J, weights)) {}

  int n, m;
  JointVector weights;
  Matrix J, W;
  test::ExpandedPseudoinverse inverse;
};

class PseudoinverseIdentities : public testing::Test {
 protected:
  template <typename Check>
  void forRandomCases(Check check) {
    test::Random random(31);
    for (int i = 0; i < 400; ++i) {
      const IdentityCase c(random);
      ASSERT_FALSE(c.inverse.factors.damped());
      check(c, c.inverse.J_sharp, c.inverse.N);
    }
  }
};

TEST_F(PseudoinverseIdentities, MoorePenrose) {
  forRandomCases([](const IdentityCase& c, const Matrix& J_sharp, const Matrix&) {
    ASSERT_LT(relative(c.J * J_sharp * c.J - c.J, c.J), kTolerance);
    ASSERT_LT(relative(J_sharp * c.J * J_sharp - J_sharp, J_sharp), kTolerance);
    ASSERT_LT(asymmetry(c.J * J_sharp), kTolerance);
    ASSERT_LT(asymmetry(c.W * J_sharp * c.J), kTolerance) << "J# J is not W-self-adjoint";
  });
}

TEST_F(PseudoinverseIdentities, TaskVelocityIsThatOfTheJoints) {
  test::Random random(32);
  forRandomCases([&](const IdentityCase& c, const Matrix&, const Matrix&) {
    const WeightedPseudoinverse& factors = c.inverse.factors;
    const PaddedTaskVector y = paddedTask(random.vector<TaskVector>(c.m, -1.0, 1.0));
    const ScaledVector inv_sqrt = test::inverseSquareRoot(c.weights);
    const Matrix q_dot = factors.expand(y).cwiseProduct(inv_sqrt).head(c.n);
    ASSERT_LT(relative(factors.taskVelocity(y) - c.J * q_dot, c.J * q_dot), kTolerance);
  });
}

TEST_F(PseudoinverseIdentities, ClosedForm) {
  forRandomCases([](const IdentityCase& c, const Matrix& J_sharp, const Matrix&) {
    const Matrix W_inv = c.weights.cwiseInverse().asDiagonal();
    // J# (J W^-1 J^T) = W^-1 J^T needs no inverse.
    const Matrix gram = c.J * W_inv * c.J.transpose();
    ASSERT_LT(relative(J_sharp * gram - W_inv * c.J.transpose(), W_inv * c.J.transpose()),
              kTolerance);
  });
}

TEST_F(PseudoinverseIdentities, ProjectorBelongsToIt) {
  forRandomCases([](const IdentityCase& c, const Matrix& J_sharp, const Matrix& N) {
    const Matrix I = Matrix::Identity(c.n, c.n);
    ASSERT_LT(relative(N - (I - J_sharp * c.J), I), kTolerance);
    ASSERT_LT(relative(N * N - N, I), kTolerance);
    ASSERT_LT((c.J * N).norm(), 1e-12 * c.J.norm() * std::max(1.0, N.norm()));
    ASSERT_LT((N * J_sharp).norm(), kTolerance * J_sharp.norm() * std::max(1.0, N.norm()));
    ASSERT_LT((c.W * N - (c.W * N).transpose()).norm(), kTolerance * c.W.norm());
    ASSERT_NEAR(N.trace(), c.n - c.m, 1e-9) << "wrong dimension of the null space";
  });
}

TEST_F(PseudoinverseIdentities, SolutionIsTheCheapestInTheWeightedNorm) {
  test::Random random(32);
  for (int i = 0; i < 400; ++i) {
    const IdentityCase c(random);
    const Eigen::VectorXd w = random.vector<Eigen::VectorXd>(c.m, -1.0, 1.0);
    const Eigen::VectorXd q_dot = c.inverse.J_sharp * w;
    const Eigen::VectorXd detour = c.inverse.N * random.vector<Eigen::VectorXd>(c.n, -1.0, 1.0);
    const auto cost = [&](const Eigen::VectorXd& v) { return v.dot(c.W * v); };
    ASSERT_LT((c.J * q_dot - w).norm(), 1e-12 * c.J.norm() * q_dot.norm());
    ASSERT_GE(cost(q_dot + detour), cost(q_dot) * (1.0 - 1e-10));
    ASSERT_GE(cost(q_dot - detour), cost(q_dot) * (1.0 - 1e-10));
  }
}

}  // namespace
}  // namespace tactus
