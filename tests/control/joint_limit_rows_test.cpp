#include "tactus/control/joint_limit_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expanded_pseudoinverse.h"
#include "support/random_jacobian.h"
#include "support/random_robot.h"

namespace tactus {
namespace {

constexpr double kGamma_per_s = 5.0;

/// An arm anywhere between its limits, and a motion that may lead anywhere.
struct LimitedCase {
  explicit LimitedCase(test::Random& random)
      : n(random.integer(2, kMaxJoints)),
        weights(test::randomWeights(random, n)),
        inv_sqrt(test::inverseSquareRoot(weights)) {
    const int m = random.integer(1, std::min(n - 1, kMaxTaskSize));
    task_size = m;
    kinematics.pseudoinverse.factorise(
        test::randomJacobian(random, test::randomSpectrum(random, m, 0.1, 5.0), weights), inv_sqrt);
    limits.lower = JointVector::Constant(n, -1.0);
    limits.upper = JointVector::Constant(n, 1.0);
    limits.max_velocity = random.vector(n, 0.2, 2.0);
    limits.max_acceleration = random.vector(n, 0.5, 20.0);
    q = random.vector(n, -1.0, 1.0);
    motion.v_scaled = scaled(random.vector(n, -1.0, 1.0), ScaledVector::Ones());
    motion.y.setZero();
    for (int i = 0; i < m; ++i) motion.y[i] = random.uniform(-1.0, 1.0);
    share = random.chance(0.5) ? 1.0 : random.uniform(0.1, 1.0);
    rows.size = 0;
    JointLimitRows(limits, false).add(q, kinematics, inv_sqrt, share, rows);
  }

  double left(int joint) const { return 1.0 - std::abs(q[joint]); }
  double allowed(int joint) const {
    const double braking = std::sqrt(limits.max_acceleration[joint] * left(joint));
    return std::min(kGamma_per_s * left(joint), braking) / share;
  }
  bool isNear(int joint) const {
    return left(joint) < 0.25 && allowed(joint) < limits.max_velocity[joint];
  }
  JointVector velocity() const {
    const ScaledVector v = motion.v_scaled + kinematics.pseudoinverse.expand(motion.y);
    return v.cwiseProduct(inv_sqrt).head(n);
  }

  int n;
  int task_size = 0;
  double share = 1.0;
  JointVector weights;
  ScaledVector inv_sqrt;
  JointLimits limits;
  JointVector q;
  TaskKinematics kinematics;
  SpeedRows rows;
  Motion motion;
};

TEST(JointLimitRows, AreThereWhereAJointCouldComeTooFast) {
  test::Random random(331);
  for (int i = 0; i < 500; ++i) {
    const LimitedCase c(random);
    int near = 0;
    for (int joint = 0; joint < c.n; ++joint) near += c.isNear(joint) ? 1 : 0;
    ASSERT_EQ(c.rows.size, near);
  }
}

TEST(JointLimitRows, ThatFadeBeginWithoutAStep) {
  test::Random random(334);
  for (int i = 0; i < 500; ++i) {
    LimitedCase c(random);
    c.q.setZero();
    for (const double left : {0.25, 0.2499999, 0.24, 0.1}) {
      c.q[0] = 1.0 - left;
      c.rows.size = 0;
      JointLimitRows(c.limits, true).add(c.q, c.kinematics, c.inv_sqrt, 1.0, c.rows);
      ASSERT_EQ(c.rows.size, left < 0.25 ? 1 : 0) << left;
      if (left < 0.25) {
        ASSERT_NEAR(c.rows.row[0].presence, 1.0 - left / 0.25, 1e-12);
      }
    }
  }
}

/// Whatever the motion was: no joint then goes to its limit faster than it may.
TEST(JointLimitRows, SlowEachJointDownOnItsWayToTheLimit) {
  test::Random random(332);
  int slowed = 0;
  for (int i = 0; i < 2000; ++i) {
    LimitedCase c(random);
    const JointVector before = c.velocity();
    RowProblem(c.rows, c.task_size).keep(c.motion);
    const JointVector after = c.velocity();
    for (int joint = 0; joint < c.n; ++joint) {
      if (!c.isNear(joint)) continue;
      const double sign = c.q[joint] > 0.0 ? 1.0 : -1.0;
      ASSERT_LE(sign * after[joint], c.allowed(joint) + 1e-3 * (1.0 + before.norm())) << i;
      slowed += sign * before[joint] > c.allowed(joint) ? 1 : 0;
    }
  }
  EXPECT_GT(slowed, 500);
}

TEST(JointLimitRows, OfAJointBeyondItsLimitLetItOnlyBack) {
  test::Random random(333);
  LimitedCase c(random);
  c.q.setZero();
  c.q[0] = 1.1;
  c.rows.size = 0;
  JointLimitRows(c.limits, false).add(c.q, c.kinematics, c.inv_sqrt, 1.0, c.rows);
  ASSERT_EQ(c.rows.size, 1);
  EXPECT_EQ(c.rows.row[0].v_max_m_per_s, 0.0);
  EXPECT_LT(c.rows.row[0].a_scaled[0], 0.0);
}

/// What is asked without rows is what the rows say.
TEST(JointLimitRows, AreKeptExactlyByWhatKeepsEachOfThem) {
  test::Random random(335);
  int kept = 0, broken = 0;
  for (int i = 0; i < 5000; ++i) {
    const LimitedCase c(random);
    const ScaledVector velocity =
        scaled(JointVector(random.logUniform(1e-3, 1.0) * random.vector(c.n, -1.0, 1.0)),
               ScaledVector::Ones());
    double least = kNoLimit;  // speed left
    for (int row = 0; row < c.rows.size; ++row) {
      const SpeedRow& told = c.rows.row[row];
      const JointVector v_scaled = velocity.head(c.n).cwiseQuotient(c.inv_sqrt.head(c.n));
      least = std::min(least, told.a_scaled.head(c.n).dot(v_scaled) + told.v_max_m_per_s);
    }
    if (std::abs(least) < 1e-9) continue;
    ASSERT_EQ(JointLimitRows(c.limits, false).isKept(c.q, velocity, c.share), least > 0.0) << i;
    (least > 0.0 ? kept : broken) += c.rows.size > 0 ? 1 : 0;
  }
  EXPECT_GT(kept, 500);
  EXPECT_GT(broken, 100);
}

TEST(JointLimitRows, AreNotKeptByAMotionThatIsNoNumber) {
  test::Random random(336);
  LimitedCase c(random);
  c.q[0] = 0.99;
  ScaledVector velocity = ScaledVector::Zero();
  EXPECT_TRUE(JointLimitRows(c.limits, true).isKept(c.q, velocity, 1.0));
  velocity[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(JointLimitRows(c.limits, true).isKept(c.q, velocity, 1.0));
}

}  // namespace
}  // namespace tactus
