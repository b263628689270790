#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/rows_case.h"

/// Rows that oppose each other and yet can all be kept.
namespace tactus {
namespace {

using test::RowsCase;

constexpr double kAsked_m_per_s = 0.1;

/// A contact with short levers that is asked to go away, which one joint would do, too, if it were
/// not at its limit. False: the others can hardly do it.
bool placeBesideALimit(test::Random& random, RowsCase& c) {
  constexpr double kScaledLength = 0.3;  // of joint-limit rows
  const int joint = random.integer(0, c.n - 1);
  JointVector a = random.vector(c.n, -1.0, 1.0);
  a *= random.logUniform(0.05, 0.3) / a.norm();
  a = a.cwiseQuotient(JointVector(c.inv_sqrt.head(c.n)));
  JointVector limit = JointVector::Zero(c.n);
  limit[joint] = std::copysign(kScaledLength / c.inv_sqrt[joint], -a[joint]);
  c.setRow(0, a);
  c.setRow(1, limit);
  c.rows.row[0].v_max_m_per_s = -kAsked_m_per_s;
  c.rows.row[0].damping_N_s_per_m = 0.1 * random.logUniform(60.0, 3e3);
  c.rows.row[1].v_max_m_per_s = 0.0;
  c.rows.row[1].damping_N_s_per_m = 2e6;
  c.motion.v_scaled.setZero();
  c.motion.y.setZero();
  ScaledVector others = c.rows.row[0].a_scaled;
  others[joint] = 0.0;
  return others.norm() > std::max(0.03, 0.5 * c.rows.row[0].a_scaled.norm());
}

TEST(OpposedRows, DoWhatIsAskedWhereBothCan) {
  test::Random random(341);
  int done = 0;
  for (int i = 0; i < 3000; ++i) {
    RowsCase c(random, 2);
    if (!placeBesideALimit(random, c)) continue;
    RowProblem(c.rows, c.m).keep(c.motion);
    const Eigen::VectorXd speed = c.A * c.joints(c.motion);
    ASSERT_GT(speed[0], 0.99 * kAsked_m_per_s) << i;
    ASSERT_GT(speed[1], -1e-4 * kAsked_m_per_s) << i;
    ++done;
  }
  EXPECT_GT(done, 2000);
}

}  // namespace
}  // namespace tactus
