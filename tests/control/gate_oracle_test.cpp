#include <CGAL/Gmpzf.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstdlib>
#include <optional>

#include "support/rows_case.h"

/// The rows against CGAL's quadratic programs, solved in exact arithmetic.
namespace tactus {
namespace {

using test::RowsCase;

long long rowsToTry() {
  const char* const rows = std::getenv("TACTUS_GATE_ROWS");
  return rows ? std::atoll(rows) : 4000;
}

/// M^1/2 in scaled joints, for M = (J#J + kappa N) W^-1: W^-1/2 (J#J + sqrt(kappa) N) W^1/2 W^-1/2.
Eigen::MatrixXd rootOfM(const RowsCase& c) {
  const Eigen::MatrixXd root_W = c.weights.cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd inv_root_W = c.weights.cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd N = root_W * c.inverse.N * inv_root_W;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(c.n, c.n);
  return inv_root_W * (one - N + std::sqrt(kBothSpaces.null_space) * N);
}

/// min 1/2 |z|^2 with B z >= d; nothing: there is none.
std::optional<Eigen::VectorXd> leastChange(const Eigen::MatrixXd& B, const Eigen::VectorXd& d) {
  CGAL::Quadratic_program<double> program(CGAL::LARGER, false, 0.0, false, 0.0);
  for (int i = 0; i < B.rows(); ++i) {
    for (int j = 0; j < B.cols(); ++j) program.set_a(j, i, B(i, j));
    program.set_b(i, d[i]);
  }
  for (int j = 0; j < B.cols(); ++j) program.set_d(j, j, 1.0);
  CGAL::Quadratic_program_options options;  // its default does not bear free variables
  options.set_pricing_strategy(CGAL::QP_DANTZIG);
  const auto solution = CGAL::solve_quadratic_program(program, CGAL::Gmpzf(), options);
  if (solution.is_infeasible()) return std::nullopt;
  Eigen::VectorXd z(B.cols());
  int j = 0;
  for (auto it = solution.variable_values_begin(); it != solution.variable_values_end(); ++it)
    z[j++] = CGAL::to_double(*it);
  return z;
}

bool opposes(const Eigen::MatrixXd& B) { return (B * B.transpose()).minCoeff() < -1e-12; }

/// Rows of a robot, some of them nearly or quite parallel, and in part opposed.
RowsCase drawRows(test::Random& random) {
  RowsCase c(random, random.integer(1, 8));
  const bool all_alike = random.chance(0.5);
  const JointVector middle = random.vector(c.n, -1.0, 1.0);
  for (int row = 0; row < c.rows.size; ++row) {
    JointVector a = c.A.row(row);
    if (all_alike) a = middle + random.uniform(0.0, 0.5) * a;
    if (row > 0 && random.chance(0.2)) a = c.A.row(random.index(row));  // degenerate
    if (row > 0 && !all_alike && random.chance(0.2)) a = -JointVector(c.A.row(random.index(row)));
    c.setRow(row, a);
  }
  return c;
}

TEST(GateOracle, RowsThatDoNotOpposeEachOtherAreTheQuadraticPrograms) {
  test::Random random(318);
  long long alike = 0, opposed = 0, infeasible = 0, active = 0;
  double largest = 0.0;
  for (long long rows = 0; rows < rowsToTry();) {
    RowsCase c = drawRows(random);
    rows += c.rows.size;
    const Eigen::VectorXd before = c.joints(c.motion);
    Eigen::VectorXd d = -(c.A * before);
    for (int row = 0; row < c.rows.size; ++row) d[row] -= c.rows.row[row].v_max_m_per_s;
    const Eigen::MatrixXd root = rootOfM(c);
    const Eigen::MatrixXd B = c.A * root;
    const std::optional<Eigen::VectorXd> expected = leastChange(B, d);
    const RowVector l = RowProblem(c.rows, c.m).keep(c.motion);
    const Eigen::VectorXd change = c.joints(c.motion) - before;
    ASSERT_TRUE(change.allFinite());
    ASSERT_GE(l.minCoeff(), 0.0);
    infeasible += expected ? 0 : 1;
    if (opposes(B)) {
      ++opposed;
      continue;
    }
    ++alike;
    ASSERT_TRUE(expected) << "what does not oppose each other can be kept";
    const Eigen::VectorXd wanted = root * *expected;
    active += wanted.norm() > 0.0 ? 1 : 0;
    const double error = (change - wanted).norm() / (1.0 + wanted.norm());
    largest = std::max(largest, error);
    ASSERT_LT(error, 1e-9) << rows;
  }
  std::printf("%lld alike (largest error %.1e), %lld opposed, %lld infeasible\n", alike, largest,
              opposed, infeasible);
  EXPECT_GT(active, alike / 4);
  EXPECT_GT(opposed, 100);
  EXPECT_GT(infeasible, 10);
}

}  // namespace
}  // namespace tactus
