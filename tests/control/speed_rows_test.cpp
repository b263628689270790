#include "tactus/control/speed_rows.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/rows_case.h"
#include "tactus/math/contact_space.h"

namespace tactus {
namespace {

using test::RowsCase;

TEST(SpeedRows, AddMATransposedL) {
  test::Random random(311);
  for (int i = 0; i < 1000; ++i) {
    RowsCase c(random, random.integer(1, 4));
    const Eigen::VectorXd before = c.joints(c.motion);
    const RowVector l = RowProblem(c.rows, c.m).keep(c.motion);
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
    const RowVector l = RowProblem(c.rows, c.m).keep(c.motion);
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
    const RowVector l = RowProblem(c.rows, c.m).keep(c.motion);
    const Eigen::VectorXd speed = c.A * c.joints(c.motion);
    ASSERT_TRUE(speed.allFinite());
    ASSERT_GT(l.minCoeff(), 0.0);
    const double force_0 = c.rows.row[0].damping_N_s_per_m * (0.1 - speed[0]);
    const double force_1 = c.rows.row[1].damping_N_s_per_m * (0.1 - speed[1]);
    ASSERT_NEAR(force_0, force_1, 0.1 * std::max(force_0, force_1)) << i;
  }
}

/// Else the gate before the drives would not see it.
TEST(SpeedRows, OfNaNMakeAMotionOfNaN) {
  test::Random random(330);
  for (int i = 0; i < 200; ++i) {
    RowsCase c(random, random.integer(1, 8));
    for (int row = 0; row < c.rows.size; ++row) c.rows.row[row].v_max_m_per_s = 1e3;
    c.rows.row[random.integer(0, c.rows.size - 1)].v_max_m_per_s =
        std::numeric_limits<double>::quiet_NaN();
    RowProblem(c.rows, c.m).keep(c.motion);
    ASSERT_FALSE(c.motion.v_scaled.allFinite()) << i;
  }
}

/// As of a contact beside the first joint's axis: what no speed of the joints gets away is not run
/// away from.
TEST(SpeedRows, OfAPointThatHardlyMovesAskForLittle) {
  test::Random random(320);
  for (int i = 0; i < 200; ++i) {
    RowsCase c(random, 1);
    const double length = random.logUniform(1e-9, 1e-4);
    c.setRow(0, JointVector(length / c.A.row(0).norm() * c.A.row(0)));
    c.rows.row[0].v_max_m_per_s = -0.1;
    const double lacking = 0.1 - (c.A * c.joints(c.motion)).value();
    const RowVector l = RowProblem(c.rows, c.m).keep(c.motion);
    ASSERT_NEAR(l[0], lacking / 1e-4, 1e-3 * lacking / 1e-4) << i;
  }
}

/// Nor is the null space asked for what next to nothing of it can do.
TEST(SpeedRows, ThatTheNullSpaceHardlyMovesAskLittleOfIt) {
  SpeedRows rows;
  rows.size = 1;
  SpeedRow& row = rows.row[0];
  row = {ScaledVector::Unit(0), PaddedTaskVector::Unit(0), -0.1, 100.0, 1.0};
  Motion rest;
  rest.v_scaled.setZero();
  rest.y.setZero();
  for (const double length : {1.0, 2.0}) {
    row.a_scaled[0] = row.a_task[0] = length;
    const RowVector l = RowProblem(rows, 1).solve(ownSpeeds(rows), kNullSpaceAlone, rest).l;
    EXPECT_NEAR(l[0], 0.1 / (1e-3 * length * length), 1e-4 / (1e-3 * length * length));
  }
}

TEST(SpeedRows, LeaveAMotionAloneThatKeepsThem) {
  test::Random random(314);
  RowsCase c(random, 3);
  for (int row = 0; row < 3; ++row) c.rows.row[row].v_max_m_per_s = 1e3;
  const Eigen::VectorXd before = c.joints(c.motion);
  EXPECT_TRUE(RowProblem(c.rows, c.m).keep(c.motion).isZero(0.0));
  EXPECT_EQ(before, c.joints(c.motion));
}

/// As of a wall that begins to be near: its row is there in one cycle and not in the next.
TEST(SpeedRows, ThatNothingCouldBreakMakeNoDifferenceToOthers) {
  test::Random random(319);
  int opposed = 0;
  for (int i = 0; i < 2000; ++i) {
    RowsCase c(random, random.integer(2, 5));
    SpeedRows more = c.rows;
    SpeedRow& wall = more.row[more.size++];
    wall = c.rows.row[0];
    wall.a_scaled *= random.chance(0.5) ? 0.0 : -1e-3;
    wall.a_task *= wall.a_scaled.isZero(0.0) ? 0.0 : -1e-3;
    wall.v_max_m_per_s = random.logUniform(1e6, 1e16);
    wall.presence = 0.0;
    for (const RowSpace& space : {kNullSpaceAlone, kBothSpaces}) {
      const RowVector l = RowProblem(c.rows, c.m).solve(ownSpeeds(c.rows), space, c.motion).l;
      const RowVector l_more = RowProblem(more, c.m).solve(ownSpeeds(more), space, c.motion).l;
      ASSERT_LE((l_more.head(c.rows.size) - l).cwiseAbs().maxCoeff(), 1e-9 * l.maxCoeff()) << i;
      opposed += (l.array() > 0.0).count() > 1 ? 1 : 0;
    }
  }
  EXPECT_GT(opposed, 1000);
}

/// With one row and no null space they are the approach limit's u_t = min(0, v_res + v_max) / k_t.
TEST(SpeedRows, OfOneContactAloneAreItsLaw) {
  test::Random random(314);
  int active = 0;
  for (int i = 0; i < 4000; ++i) {
    const RowsCase c(random, 1);
    const SpeedRow& row = c.rows.row[0];
    const double k_j = dot(row.a_scaled, row.a_scaled);
    const double k_t = dot(row.a_task, row.a_task, c.m);
    const double v_res = dot(row.a_scaled, c.motion.v_scaled) + dot(row.a_task, c.motion.y, c.m);
    const double u_t = std::min(0.0, v_res + row.v_max_m_per_s) * invertRegularised(k_t, k_j);
    const RowMultipliers found =
        RowProblem(c.rows, c.m).solve(ownSpeeds(c.rows), {1.0, 0.0, kNoLimit, 1e-6}, c.motion);
    ASSERT_TRUE(found.is_whole);
    ASSERT_NEAR(found.l[0], -u_t, 1e-12 * (1.0 + std::abs(u_t))) << i;
    active += u_t < 0.0 ? 1 : 0;
  }
  EXPECT_GT(active, 1000);
}

TEST(SpeedRows, InTheNullSpaceAloneLeaveTheTask) {
  test::Random random(315);
  for (int i = 0; i < 1000; ++i) {
    RowsCase c(random, random.integer(1, 8));
    const Eigen::VectorXd before = c.joints(c.motion);
    const RowMultipliers found =
        RowProblem(c.rows, c.m).solve(ownSpeeds(c.rows), kNullSpaceAlone, c.motion);
    addRows(c.rows, found.l, kNullSpaceAlone, c.motion);
    const Eigen::VectorXd change = c.joints(c.motion) - before;
    ASSERT_LT((change - c.inverse.N * change).norm(), 1e-9 * (1.0 + change.norm())) << i;
  }
}

/// Of rows that a null space cannot keep at once. Each of four repetitions adds at most what lacks
/// over rho K, in the norm of rho K: however singular they are, pushes have a bound.
TEST(SpeedRows, InTheNullSpaceAloneAskForNoMoreThanWhatLacksOverRho) {
  test::Random random(320);
  int singular = 0;
  for (int i = 0; i < 2000; ++i) {
    RowsCase c(random, random.integer(2, 6));
    const JointVector last = c.A.row(0);
    for (int row = 1; row < c.rows.size; ++row) {  // all but opposed to each other, or alike
      const double sign = random.chance(0.5) ? -1.0 : 1.0;
      c.setRow(row, sign * last + random.logUniform(1e-6, 1.0) * random.vector(c.n, -1.0, 1.0));
    }
    const RowVector l =
        RowProblem(c.rows, c.m).solve(ownSpeeds(c.rows), kNullSpaceAlone, c.motion).l;
    double pushed = 0.0, lacks = 0.0;
    for (int row = 0; row < c.rows.size; ++row) {
      const SpeedRow& one = c.rows.row[row];
      const double all = dot(one.a_scaled, one.a_scaled);
      const double K = std::max({all - dot(one.a_task, one.a_task, c.m), 1e-3 * all, 1e-4});
      const double d = std::max(0.0, -one.v_max_m_per_s - speedAlong(one, c.m, c.motion));
      pushed += kNullSpaceAlone.proximal * K * l[row] * l[row];
      lacks += d * d / (kNullSpaceAlone.proximal * K);
    }
    ASSERT_LE(pushed, 16.0 * lacks * (1.0 + 1e-9)) << i;
    singular += pushed > lacks ? 1 : 0;
  }
  EXPECT_GT(singular, 10);
}

/// Whatever the solver has no time for: the arm stops before it breaks a row that standing keeps.
TEST(SpeedRows, AreKeptByASlowerMotionWhereTheSolverMustEndEarly) {
  test::Random random(316);
  int cut = 0;
  for (int i = 0; i < 5000; ++i) {
    RowsCase c(random, random.integer(2, kMaxRows));
    const int products = random.integer(0, 40 * c.rows.size);
    const bool is_whole =
        RowProblem(c.rows, c.m, products).solve(ownSpeeds(c.rows), kBothSpaces, c.motion).is_whole;
    RowProblem(c.rows, c.m, products).keep(c.motion);
    const Eigen::VectorXd speed = c.A * c.joints(c.motion);
    ASSERT_TRUE(speed.allFinite());
    if (is_whole) continue;
    ++cut;
    for (int row = 0; row < c.rows.size; ++row) {
      const double v_max = c.rows.row[row].v_max_m_per_s;
      if (v_max >= 0.0) {
        ASSERT_GE(speed[row], -v_max - 1e-9) << i;
      }
    }
  }
  EXPECT_GT(cut, 1000);
}

/// The second level finds what the first one had to leave it.
TEST(SpeedRows, HaveHalfOfTheProductsForTheSecondLevel) {
  test::Random random(323);
  int cut = 0;
  for (int i = 0; i < 1000; ++i) {
    RowsCase c(random, random.integer(4, 40));
    const int step = c.rows.size * c.rows.size * 2;
    const int products = 2 * (random.integer(100, 4000) + step);
    RowProblem both(c.rows, c.m, products), second(c.rows, c.m, products / 2 - step);
    Motion motion = c.motion;
    cut += both.solve(ownSpeeds(c.rows), kNullSpaceAlone, motion, 0.5).is_whole ? 0 : 1;
    if (!RowProblem(second).solve(ownSpeeds(c.rows), kBothSpaces, motion).is_whole) continue;
    Motion other = motion;
    ASSERT_EQ(both.keep(motion), second.keep(other)) << i;
    ASSERT_EQ(motion.v_scaled, other.v_scaled);
  }
  EXPECT_GT(cut, 100);
}

/// And no slower than the first of them asks for, whatever hardly moves or stands.
TEST(SpeedRows, SlowAMotionDownNoFurtherThanTheyHaveTo) {
  test::Random random(321);
  int slowed = 0, stopped = 0;
  for (int i = 0; i < 3000; ++i) {
    RowsCase c(random, random.integer(2, 6));
    for (int row = 0; row < c.rows.size; ++row) {
      if (random.chance(0.2)) c.rows.row[row].v_max_m_per_s = 0.0;
      if (random.chance(0.3)) c.setRow(row, JointVector(JointVector::Zero(c.n)));
    }
    const Eigen::VectorXd before = c.joints(c.motion);
    const Eigen::VectorXd approach = -c.A * before;
    double share = 1.0;
    for (int row = 0; row < c.rows.size; ++row) {
      const double v_max = c.rows.row[row].v_max_m_per_s;
      if (v_max >= 0.0 && approach[row] > 0.0) share = std::min(share, v_max / approach[row]);
    }
    const bool is_whole =
        RowProblem(c.rows, c.m, 0).solve(ownSpeeds(c.rows), kBothSpaces, c.motion).is_whole;
    if (is_whole) continue;
    RowProblem(c.rows, c.m, 0).keep(c.motion);
    ASSERT_LT((c.joints(c.motion) - share * before).norm(), 1e-9 * (1.0 + before.norm())) << i;
    slowed += share > 0.0 && share < 1.0 ? 1 : 0;
    stopped += share == 0.0 ? 1 : 0;
  }
  EXPECT_GT(slowed, 100);
  EXPECT_GT(stopped, 100);
}

TEST(SpeedRows, AddEachMultiplierByItself) {
  test::Random random(322);
  const RowsCase c(random, 1);
  for (const double l : {0.0, 0.5, 1.0, 2.0}) {
    Motion motion = c.motion;
    addRows(c.rows, RowVector::Constant(1, l), kBothSpaces, motion);
    const ScaledVector added = motion.v_scaled - c.motion.v_scaled;
    ASSERT_LT((added - 30.0 * l * c.rows.row[0].a_scaled).norm(), 1e-12);
  }
}

/// Room that an earlier cycle has used is no row.
TEST(SpeedRows, EndWhereTheirNumberSays) {
  test::Random random(318);
  int cut = 0;
  for (int i = 0; i < 2000; ++i) {
    RowsCase c(random, random.integer(2, kMaxRows - 1));
    Motion motion = c.motion, other = c.motion;
    const bool is_whole =
        RowProblem(c.rows, c.m, 0).solve(ownSpeeds(c.rows), kBothSpaces, motion).is_whole;
    cut += is_whole ? 0 : 1;
    RowProblem(c.rows, c.m, 0).keep(motion);
    SpeedRow& beyond = c.rows.row[c.rows.size];
    beyond = c.rows.row[0];
    beyond.v_max_m_per_s = 0.0;
    beyond.a_scaled = -c.motion.v_scaled;
    beyond.a_task = -c.motion.y;
    RowProblem(c.rows, c.m, 0).keep(other);
    ASSERT_EQ(other.v_scaled, motion.v_scaled) << i;
    ASSERT_EQ(other.y, motion.y) << i;
  }
  EXPECT_GT(cut, 500);
}

/// What the bound of the solver's steps is for.
TEST(SpeedRows, AreSolvedWithinTheirStepsHoweverTheyOpposeEachOther) {
  test::Random random(317);
  for (int i = 0; i < 3000; ++i) {
    RowsCase c(random, random.integer(2, kMaxRows));
    for (int row = 1; row < c.rows.size; ++row) {
      if (!random.chance(0.3)) continue;
      const JointVector other = c.A.row(random.index(row));
      c.setRow(row, JointVector(random.sign() * other + 1e-3 * random.vector(c.n, -1.0, 1.0)));
    }
    const RowMultipliers found =
        RowProblem(c.rows, c.m).solve(ownSpeeds(c.rows), kBothSpaces, c.motion);
    ASSERT_TRUE(found.is_whole) << i;
    ASSERT_TRUE(found.l.allFinite() && found.l.minCoeff() >= 0.0);
  }
}

}  // namespace
}  // namespace tactus
