#include "tactus/math/contact_space.h"

#include <gtest/gtest.h>

#include "support/expanded_pseudoinverse.h"
#include "support/random_jacobian.h"
#include "support/random_robot.h"

namespace tactus {
namespace {

struct RandomContact {
  explicit RandomContact(test::Random& random, double smallest_singular_value = 0.05)
      : n(random.integer(2, kMaxJoints)),
        m(random.integer(1, std::min(n, kMaxTaskSize))),
        weights(test::randomWeights(random, n)),
        J(test::randomJacobian(
            random, test::randomSpectrum(random, m, smallest_singular_value, 5.0), weights)),
        a(random.vector(n, -1.0, 1.0)),
        w_eff(random.vector<TaskVector>(m, -1.0, 1.0)),
        inverse(test::expandPseudoinverse(J, weights)) {
    computeContactSpace(inverse.factors, scaled(a, ScaledVector::Ones()),
                        test::inverseSquareRoot(weights), inverse.factors.solve(w_eff), space);
  }

  int n, m;
  JointVector weights;
  TaskJacobian J;
  JointVector a;
  TaskVector w_eff;
  test::ExpandedPseudoinverse inverse;
  ContactSpace space;
};

TEST(ContactSpace, AgreesWithTheMatricesOfThePaper) {
  test::Random random(81);
  for (int i = 0; i < 1000; ++i) {
    const RandomContact c(random);
    const Eigen::VectorXd b = c.a.cwiseQuotient(c.weights);
    const Eigen::MatrixXd J = c.J;
    const double scale = c.a.dot(b);
    ASSERT_NEAR(c.space.k_j, c.a.dot(b), 1e-12 * scale);
    ASSERT_NEAR(c.space.k_t, c.a.dot(c.inverse.J_sharp * (J * b)), 1e-10 * scale);
    ASSERT_NEAR(c.space.k_n, c.a.dot(c.inverse.N * b), 1e-10 * scale);
    const double x_dot_eff = c.a.dot(c.inverse.J_sharp * c.w_eff);
    ASSERT_NEAR(c.space.x_dot_eff_m_per_s, x_dot_eff, 1e-10 * (1.0 + std::abs(x_dot_eff)));
  }
}

TEST(ContactSpace, SpacesAddUpAndAreNeverNegative) {
  test::Random random(82);
  for (int i = 0; i < 3000; ++i) {
    // Singular poses, where the task inverse is damped, included.
    const RandomContact c(random, random.logUniform(1e-18, 1.0));
    ASSERT_GE(c.space.k_n, 0.0);
    ASSERT_GE(c.space.k_t, 0.0);
    ASSERT_NEAR(c.space.k_n + c.space.k_t, c.space.k_j, 1e-12 * c.space.k_j) << "case " << i;
  }
}

TEST(ContactSpace, ShowsWhyThePlainTransposeWillNotDo) {
  // The factor as printed, J_p^T F^ with W != I, makes some k negative: the test would notice it.
  test::Random random(83);
  int negative = 0;
  for (int i = 0; i < 3000; ++i) {
    const RandomContact c(random);
    const Eigen::MatrixXd J = c.J;
    const double k_t = c.a.dot(c.inverse.J_sharp * (J * c.a));
    const double k_n = c.a.dot(c.inverse.N * c.a);
    negative += k_t < 0.0 || k_n < 0.0;
  }
  EXPECT_GT(negative, 100);
}

TEST(ContactSpace, HasNoNullSpaceWithoutRedundancy) {
  test::Random random(84);
  for (int n = 2; n <= 6; ++n) {
    const JointVector weights = test::randomWeights(random, n);
    const TaskJacobian J =
        test::randomJacobian(random, test::randomSpectrum(random, n, 0.05, 5.0), weights);
    const test::ExpandedPseudoinverse inverse = test::expandPseudoinverse(J, weights);
    ContactSpace space;
    computeContactSpace(inverse.factors, scaled(random.vector(n, -1.0, 1.0), ScaledVector::Ones()),
                        test::inverseSquareRoot(weights), PaddedTaskVector::Zero(), space);
    EXPECT_LT(space.k_n, 1e-25 * space.k_j);
    EXPECT_NEAR(space.k_t, space.k_j, 1e-12 * space.k_j);
  }
}

TEST(InvertRegularised, IsTheInverseBoundedByTwoFloors) {
  EXPECT_EQ(invertRegularised(0.5, 1.0), 2.0);
  EXPECT_EQ(invertRegularised(1e-3, 0.5), 1e3);
  EXPECT_DOUBLE_EQ(invertRegularised(1e-9, 2.0), 500.0);  // 1e-3 k_j
  EXPECT_DOUBLE_EQ(invertRegularised(1e-9, 1e-6), 1e4);   // 1e-4 m^2
  EXPECT_DOUBLE_EQ(invertRegularised(0.0, 0.0), 1e4);
}

}  // namespace
}  // namespace tactus
