#include "tactus/control/speed_rows.h"

#include <gtest/gtest.h>

#include "support/expanded_pseudoinverse.h"
#include "support/random_jacobian.h"
#include "support/random_robot.h"

namespace tactus {
namespace {

/// Rows and a motion of a random robot, and what both mean in joints.
struct RowsCase {
  RowsCase(test::Random& random, int count)
      : n(random.integer(4, kMaxJoints)),
        m(random.integer(1, std::min(n - 1, kMaxTaskSize))),
        weights(test::randomWeights(random, n)),
        inv_sqrt(test::inverseSquareRoot(weights)),
        inverse(test::expandPseudoinverse(
            test::randomJacobian(random, test::randomSpectrum(random, m, 0.1, 5.0), weights),
            weights)) {
    rows.size = count;
    for (int i = 0; i < count; ++i) {
      setRow(i, random.vector(n, -1.0, 1.0));
      rows.row[i].v_max_m_per_s = random.uniform(-0.2, 0.5);
      rows.row[i].damping_N_s_per_m = random.logUniform(10.0, 1e5);
    }
    motion.v_scaled = scaled(random.vector(n, -1.0, 1.0), ScaledVector::Ones());
    motion.y.setZero();
    for (int i = 0; i < m; ++i) motion.y[i] = random.uniform(-1.0, 1.0);
  }

  void setRow(int i, const JointVector& a) {
    if (A.rows() == 0) A = Eigen::MatrixXd::Zero(rows.size, n);
    A.row(i) = a;
    rows.row[i].a_scaled = scaled(a, inv_sqrt);
    rows.row[i].a_task = inverse.factors.project(rows.row[i].a_scaled);
  }

  Eigen::VectorXd joints(const Motion& of) const {
    const ScaledVector v = of.v_scaled + inverse.factors.expand(of.y);
    return v.cwiseProduct(inv_sqrt).head(n);
  }

  int n, m;
  JointVector weights;
  ScaledVector inv_sqrt;
  test::ExpandedPseudoinverse inverse;
  SpeedRows rows;
  Eigen::MatrixXd A;
  Motion motion;
};

TEST(SpeedRows, AddMATransposedL) {
  test::Random random(311);
  for (int i = 0; i < 1000; ++i) {
    RowsCase c(random, random.integer(1, 4));
    const Eigen::VectorXd before = c.joints(c.motion);
    const RowVector l = keepSpeedRows(c.rows, c.m, c.motion);
    const Eigen::MatrixXd N = c.inverse.N;
    const Eigen::MatrixXd J_J = Eigen::MatrixXd::Identity(c.n, c.n) - N;
    const Eigen::MatrixXd W_inv = c.weights.cwiseInverse().asDiagonal();
    const Eigen::VectorXd expected =
        before + (J_J + 30.0 * N) * W_inv * c.A.transpose() * Eigen::VectorXd(l);
    const Eigen::VectorXd after = c.joints(c.motion);
    ASSERT_LT((after - expected).norm(), 1e-9 * (1.0 + expected.norm())) << i;
  }
}

/// Rows without opponents are kept, and nothing more is done than they ask for.
TEST(SpeedRows, AreKeptExactly) {
  test::Random random(312);
  int active = 0;
  for (int i = 0; i < 2000; ++i) {
    RowsCase c(random, 1);
    if (random.chance(0.5)) {  // two that point alike
      c.rows.size = 2;
      const Eigen::MatrixXd first = c.A;
      c.A.conservativeResize(2, c.n);
      const JointVector a = JointVector(first.row(0)) + 0.01 * random.vector(c.n, -1.0, 1.0);
      c.setRow(1, a);
      c.rows.row[1].damping_N_s_per_m = 100.0;
    }
    const RowVector l = keepSpeedRows(c.rows, c.m, c.motion);
    const Eigen::VectorXd speed = c.A * c.joints(c.motion);
    for (int row = 0; row < c.rows.size; ++row) {
      const double excess = speed[row] + c.rows.row[row].v_max_m_per_s;
      ASSERT_GE(excess, -1e-6 * (1.0 + std::abs(speed[row]))) << i;
      if (l[row] > 1e-3) {
        ASSERT_LE(excess, 1e-4 * (1.0 + std::abs(speed[row]))) << i;
      }
    }
    active += l.sum() > 0.0 ? 1 : 0;
  }
  EXPECT_GT(active, 500);
}

/// Squeezed from both sides, each asking the arm to go away faster than 0.1 m/s: it stays between
/// them, and the one that costs less force gives way.
TEST(SpeedRows, ThatExcludeEachOtherShareByForce) {
  test::Random random(313);
  for (int i = 0; i < 200; ++i) {
    RowsCase c(random, 2);
    c.setRow(1, JointVector(-c.A.row(0)));
    for (int row = 0; row < 2; ++row) {
      c.rows.row[row].v_max_m_per_s = -0.1;
      // So that delta is small beside K, and not as small as what keeps K regular.
      const double share = random.logUniform(1e-3, 1e-2);
      c.rows.row[row].damping_N_s_per_m = 1.5 / (share * c.rows.row[0].a_scaled.squaredNorm());
    }
    const RowVector l = keepSpeedRows(c.rows, c.m, c.motion);
    const Eigen::VectorXd speed = c.A * c.joints(c.motion);
    ASSERT_TRUE(speed.allFinite());
    ASSERT_GT(l.minCoeff(), 0.0);
    const double force_0 = c.rows.row[0].damping_N_s_per_m * (0.1 - speed[0]);
    const double force_1 = c.rows.row[1].damping_N_s_per_m * (0.1 - speed[1]);
    ASSERT_NEAR(force_0, force_1, 0.1 * std::max(force_0, force_1)) << i;
  }
}

TEST(SpeedRows, LeaveAMotionAloneThatKeepsThem) {
  test::Random random(314);
  RowsCase c(random, 3);
  for (int row = 0; row < 3; ++row) c.rows.row[row].v_max_m_per_s = 1e3;
  const Eigen::VectorXd before = c.joints(c.motion);
  EXPECT_TRUE(keepSpeedRows(c.rows, c.m, c.motion).isZero(0.0));
  EXPECT_EQ(before, c.joints(c.motion));
}

}  // namespace
}  // namespace tactus
