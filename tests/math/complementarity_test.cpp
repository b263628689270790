#include "tactus/math/complementarity.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <optional>

#include "support/random.h"
#include "tactus/math/few_complementarity.h"

namespace tactus {
namespace {

struct Problem {
  /// opposition: 0..1, how nearly two of the rows exclude each other.
  Problem(test::Random& random, int rows, double opposition) : K(rows, rows), d(rows) {
    Eigen::MatrixXd A(rows, rows + 2);
    for (double& entry : A.reshaped()) entry = random.uniform(-1.0, 1.0);
    if (rows > 1) A.row(1) = (1.0 - opposition) * A.row(1) - opposition * A.row(0);
    K = A * A.transpose() + 1e-6 * Eigen::MatrixXd::Identity(rows, rows);
    for (double& entry : d) entry = random.uniform(-1.0, 1.0);
  }
  RowMatrix K;
  RowVector d;
};

/// By trying all sets of active rows.
std::optional<Eigen::VectorXd> bruteForce(const Problem& p) {
  const auto n = static_cast<int>(p.d.size());
  for (int set = 0; set < 1 << n; ++set) {
    Eigen::MatrixXd K = p.K;
    Eigen::VectorXd d = p.d;
    for (int i = 0; i < n; ++i) {
      if ((set >> i & 1) != 0) continue;
      K.row(i).setZero();
      K.col(i).setZero();
      K(i, i) = 1.0;
      d[i] = 0.0;
    }
    const Eigen::VectorXd l = K.ldlt().solve(d);
    const Eigen::VectorXd lack = p.d - p.K * l;
    if (l.minCoeff() >= -1e-9 && lack.maxCoeff() <= 1e-9) return l;
  }
  return {};
}

constexpr int kPlenty = 10'000'000;

template <typename Solver>
bool solve(const RowVector& d, Solver& problem) {
  int products_left = kPlenty;
  return problem.solve(d, products_left);
}

template <typename Solver>
void findTheOneSolution(test::Random& random, int draws, int most_rows, int least_active) {
  int with_active = 0;
  for (int i = 0; i < draws; ++i) {
    const Problem p(random, random.integer(1, most_rows), random.chance(0.5) ? 0.0 : 0.9);
    Solver problem(p.K);
    ASSERT_TRUE(solve(p.d, problem));
    const RowVector& l = problem.l();
    const auto expected = bruteForce(p);
    ASSERT_TRUE(expected);
    ASSERT_LT((l - *expected).norm(), 1e-6 * (1.0 + expected->norm())) << i;
    with_active += l.maxCoeff() > 0.0 ? 1 : 0;
  }
  EXPECT_GT(with_active, least_active);
}

TEST(Complementarity, FindsTheOneSolution) {
  test::Random random(301);
  findTheOneSolution<Complementarity>(random, 500, 6, 100);
}

TEST(FewComplementarity, FindsTheOneSolution) {
  test::Random random(306);
  findTheOneSolution<FewComplementarity>(random, 2000, FewComplementarity::kMost, 400);
}

TEST(Complementarity, KeepsItsConditionsForAnyNumberOfRows) {
  test::Random random(302);
  for (int i = 0; i < 3000; ++i) {
    const Problem p(random, random.integer(1, kMaxRows), random.uniform(0.0, 0.999));
    Complementarity problem(p.K);
    ASSERT_TRUE(solve(p.d, problem)) << i;
    const RowVector& l = problem.l();
    const Eigen::VectorXd lack = p.d - p.K * l;
    const double scale = p.d.norm() + p.K.norm() * l.norm();
    ASSERT_GE(l.minCoeff(), 0.0);
    ASSERT_LE(lack.maxCoeff(), 1e-9 * scale) << i;
    ASSERT_LE(std::abs(l.dot(lack)), 1e-9 * scale * (1.0 + l.norm())) << i;
  }
}

/// Whatever was solved before, as there is one solution.
TEST(Complementarity, GoesOnFromItsLastSolution) {
  test::Random random(304);
  int changed = 0;
  for (int i = 0; i < 500; ++i) {
    const Problem p(random, random.integer(1, 20), random.uniform(0.0, 0.9));
    Complementarity going_on(p.K);
    RowVector d = p.d;
    for (int k = 0; k < 10; ++k) {
      const RowVector before = going_on.l();
      ASSERT_TRUE(solve(d, going_on));
      Complementarity fresh(p.K);
      ASSERT_TRUE(solve(d, fresh));
      const double scale = 1.0 + fresh.l().norm();
      ASSERT_LT((going_on.l() - fresh.l()).norm(), 1e-6 * scale) << i << " " << k;
      changed += ((before.array() > 0.0) != (fresh.l().array() > 0.0)).any() ? 1 : 0;
      const double size = random.logUniform(1e-3, 2.0);
      for (double& entry : d) entry += random.uniform(-size, size);
    }
  }
  EXPECT_GT(changed, 1000);
}

/// By its own count, of a solution that is cut anywhere. callgrind.gate_worst looks at the time.
TEST(Complementarity, TakesNoMoreThanItsProductsAndOneStep) {
  test::Random random(305);
  int cut = 0;
  for (int i = 0; i < 3000; ++i) {
    const int rows = random.integer(1, kMaxRows);
    const Problem p(random, rows, random.uniform(0.0, 0.999));
    Complementarity problem(p.K);
    const int products = random.integer(0, 300 * rows);
    int left = products;
    const bool is_whole = problem.solve(p.d, left);
    ASSERT_LE(left, products);
    const int step = rows * rows * rows + 3 * rows * rows + 40;  // all let go, and solved
    ASSERT_GE(left, -step) << i;
    ASSERT_GE(problem.l().minCoeff(), 0.0);
    ASSERT_TRUE(problem.l().allFinite());
    if (is_whole) continue;
    ASSERT_LE(left, 0);
    ++cut;
    int more = kPlenty;
    ASSERT_TRUE(problem.solve(p.d, more)) << "goes on where it was cut";
    ASSERT_LE((p.d - p.K * problem.l()).maxCoeff(), 1e-9 * (1.0 + p.K.norm() * problem.l().norm()));
  }
  EXPECT_GT(cut, 500);
}

/// Whatever was solved before, also where two rows all but exclude each other.
TEST(FewComplementarity, FindsWhatComplementarityFinds) {
  test::Random random(307);
  int changed = 0;
  for (int i = 0; i < 3000; ++i) {
    const int rows = random.integer(1, FewComplementarity::kMost);
    const Problem p(random, rows, random.uniform(0.0, 0.999));
    FewComplementarity going_on(p.K);
    RowVector d = p.d;
    for (int k = 0; k < 20; ++k) {
      const RowVector before = going_on.l();
      ASSERT_TRUE(solve(d, going_on));
      Complementarity other(p.K);
      ASSERT_TRUE(solve(d, other));
      const double scale = 1.0 + other.l().norm();
      ASSERT_LT((going_on.l() - other.l()).norm(), 1e-6 * scale) << i << " " << k;
      for (int row = rows; row < FewComplementarity::kMost; ++row)
        ASSERT_EQ(going_on.l().data()[row], 0.0) << "in the room beyond its rows";
      changed += ((before.array() > 0.0) != (other.l().array() > 0.0)).any() ? 1 : 0;
      const double size = random.logUniform(1e-3, 2.0);
      for (double& entry : d) entry += random.uniform(-size, size);
    }
    going_on.forget();
    ASSERT_TRUE(going_on.l().isZero(0.0));
  }
  EXPECT_GT(changed, 5000);
}

TEST(FewComplementarity, TakesNoMoreThanItsProductsAndOneStep) {
  test::Random random(308);
  int cut = 0;
  for (int i = 0; i < 2000; ++i) {
    const int rows = random.integer(1, FewComplementarity::kMost);
    const Problem p(random, rows, random.uniform(0.0, 0.999));
    FewComplementarity problem(p.K);
    const int products = random.integer(0, 200);
    int left = products;
    const bool is_whole = problem.solve(p.d, left);
    ASSERT_LE(left, products);
    ASSERT_GE(left, -60) << i;
    ASSERT_GE(problem.l().minCoeff(), 0.0);
    if (is_whole) continue;
    ASSERT_LE(left, 0);
    ++cut;
    int more = kPlenty;
    ASSERT_TRUE(problem.solve(p.d, more)) << "goes on where it was cut";
    ASSERT_LE((p.d - p.K * problem.l()).maxCoeff(), 1e-9 * (1.0 + p.K.norm() * problem.l().norm()));
  }
  EXPECT_GT(cut, 300);
}

template <typename Solver>
void askForNothing(test::Random& random, int rows) {
  Problem p(random, rows, 0.0);
  p.d = -p.d.cwiseAbs();
  Solver problem(p.K);
  ASSERT_TRUE(solve(p.d, problem));
  EXPECT_TRUE(problem.l().isZero(0.0));
}

TEST(Complementarity, AsksForNothingWhereNothingLacks) {
  test::Random random(303);
  askForNothing<Complementarity>(random, 5);
}

TEST(FewComplementarity, AsksForNothingWhereNothingLacks) {
  test::Random random(309);
  askForNothing<FewComplementarity>(random, FewComplementarity::kMost);
}

}  // namespace
}  // namespace tactus
