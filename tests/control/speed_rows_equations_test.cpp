#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "support/rows_case.h"

/// The equations of speed_rows.h, with whole matrices, and by trying which rows are held.
namespace tactus {
namespace {

/// l >= 0, K l >= d, complementary.
Eigen::VectorXd triedMultipliers(const Eigen::MatrixXd& K, const Eigen::VectorXd& d) {
  const auto rows = static_cast<int>(d.size());
  Eigen::VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (unsigned held = 0; held < 1u << rows; ++held) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(rows, rows);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(rows);
    for (int i = 0; i < rows; ++i) {
      if ((held >> i & 1u) == 0) continue;
      A.row(i) = K.row(i);
      b[i] = d[i];
    }
    const Eigen::VectorXd l = A.partialPivLu().solve(b);
    const double off = std::max((d - K * l).maxCoeff(), -l.cwiseProduct(K.diagonal()).minCoeff());
    if (!(off < least)) continue;
    least = off;
    best = l;
  }
  return best;
}

Eigen::VectorXd writtenMultipliers(const test::RowsCase& c, const RowSpace& space) {
  const Eigen::MatrixXd N = c.inverse.N;
  const Eigen::MatrixXd J_J = Eigen::MatrixXd::Identity(c.n, c.n) - N;
  const Eigen::MatrixXd W_inv = c.weights.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd M = (space.task * J_J + space.null_space * N) * W_inv;
  Eigen::MatrixXd K = c.A * M * c.A.transpose();
  const Eigen::MatrixXd all = c.A * W_inv * c.A.transpose();
  for (int i = 0; i < c.rows.size; ++i) K(i, i) = std::max({K(i, i), 1e-3 * all(i, i), 1e-4});
  Eigen::VectorXd d = -c.A * c.joints(c.motion), delta(c.rows.size);
  double share = 1.0;
  for (int i = 0; i < c.rows.size; ++i) {
    const SpeedRow& row = c.rows.row[i];
    d[i] -= row.v_max_m_per_s;
    double opposed = 0.0;
    for (int j = 0; j < c.rows.size; ++j) {
      if (j == i || K(i, j) >= 0.0) continue;
      opposed += row.presence * c.rows.row[j].presence * K(i, j) * K(i, j) / (K(i, i) * K(j, j));
    }
    delta[i] = 1.5 / row.damping_N_s_per_m * std::min(1.0, opposed);
    if (opposed > 0.0) share = std::min(share, space.max_yielding * K(i, i) / delta[i]);
  }
  delta = share * delta + space.proximal * K.diagonal();
  Eigen::VectorXd l = Eigen::VectorXd::Zero(c.rows.size);
  const Eigen::MatrixXd yielding = K + Eigen::MatrixXd(delta.asDiagonal());
  for (int i = 0; i < 4; ++i)
    l = triedMultipliers(yielding, Eigen::VectorXd(d + delta.cwiseProduct(l)));
  return l;
}

TEST(SpeedRowsEquations, AreSolvedForAnyFewRows) {
  test::Random random(331);
  int opposed = 0;
  for (int i = 0; i < 2000; ++i) {
    test::RowsCase c(random, random.integer(1, 5));
    for (int row = 0; row < c.rows.size; ++row) {
      c.rows.row[row].presence = random.chance(0.5) ? 1.0 : random.uniform(0.0, 1.0);
      c.rows.row[row].damping_N_s_per_m = random.logUniform(1.0, 1e3);
      if (row == 0 || random.chance(0.5)) continue;  // else one that is like the first, or against
      const double sign = random.sign();
      c.setRow(row, JointVector(sign * c.A.row(0).transpose() + 0.3 * random.vector(c.n, -1., 1.)));
    }
    for (const RowSpace& space : {kNullSpaceAlone, kBothSpaces}) {
      const RowVector l = RowProblem(c.rows, c.m).solve(ownSpeeds(c.rows), space, c.motion).l;
      const Eigen::VectorXd expected = writtenMultipliers(c, space);
      ASSERT_LT((Eigen::VectorXd(l) - expected).cwiseAbs().maxCoeff(),
                1e-6 * (1.0 + expected.cwiseAbs().maxCoeff()))
          << i << ": " << l.transpose() << ", not " << expected.transpose();
      opposed += (l.array() > 0.0).count() > 1 ? 1 : 0;
    }
  }
  EXPECT_GT(opposed, 1000);
}

}  // namespace
}  // namespace tactus
