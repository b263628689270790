#include <gtest/gtest.h>

#include "support/random_limits.h"
#include "tactus/control/command_limiter.h"

/// Long runs against position limits: whatever is commanded, no joint passes its limit, and no
/// joint needs more than its acceleration to stay away from it.
namespace tactus {
namespace {

struct Arm {
  explicit Arm(test::Random& random)
      : n(random.integer(2, 8)),
        limits(test::randomLimits(random, n)),
        q(n),
        v(JointVector::Zero(n)),
        period_s(random.logUniform(2e-4, 0.02)) {
    for (int i = 0; i < n; ++i)
      q[i] =
          std::isfinite(limits.lower[i]) ? random.uniform(limits.lower[i], limits.upper[i]) : 0.0;
  }

  /// One cycle; nothing but the gate keeps q within its limits.
  void step(JointVector wanted) {
    const JointVector before = v;
    CommandLimiter(limits).apply(q, before, period_s, wanted);
    v = wanted;
    q += period_s * v;
    for (int i = 0; i < n; ++i) {
      const double change = limits.max_acceleration[i] * period_s;
      ASSERT_TRUE(std::isfinite(v[i]));
      ASSERT_LE(std::abs(v[i]), limits.max_velocity[i]);
      ASSERT_LE(std::abs(v[i] - before[i]), change * (1.0 + 1e-12) + 1e-14) << "acceleration " << i;
      ASSERT_GE(q[i], limits.lower[i] - 1e-12) << "joint " << i;
      ASSERT_LE(q[i], limits.upper[i] + 1e-12) << "joint " << i;
    }
  }

  int n;
  JointLimits limits;
  JointVector q, v;
  double period_s;
};

class CommandLimiterBraking : public testing::Test {
 protected:
  template <typename Command>
  void run(std::uint64_t seed, Command command) {
    test::Random random(seed);
    for (int i = 0; i < 150; ++i) {
      Arm arm(random);
      for (int cycle = 0; cycle < 3000; ++cycle) {
        arm.step(command(random, arm, cycle));
        if (HasFatalFailure()) FAIL() << "arm " << i << " cycle " << cycle;
      }
    }
  }
};

TEST_F(CommandLimiterBraking, HoldsForRandomCommands) {
  run(171, [](test::Random& random, const Arm& arm, int) {
    return JointVector(random.vector(arm.n, -20.0, 20.0));
  });
}

TEST_F(CommandLimiterBraking, HoldsForSteadyPushesAgainstTheLimits) {
  JointVector push;
  run(172, [&](test::Random& random, const Arm& arm, int cycle) {
    if (cycle % 500 == 0) push = random.logUniform(0.01, 100.0) * random.vector(arm.n, -1.0, 1.0);
    return push;
  });
}

TEST_F(CommandLimiterBraking, HoldsForHostileNumbers) {
  run(173, [](test::Random& random, const Arm& arm, int cycle) {
    JointVector wanted(arm.n);
    for (double& value : wanted)
      value = cycle % 100 < 60 ? 50.0 * random.sign() : test::hostileNumber(random);
    return wanted;
  });
}

TEST_F(CommandLimiterBraking, ReachesTheLimitAndRestsThere) {
  for (const double acceleration : {1.0, 200.0, kNoLimit}) {
    JointLimits limits = test::noLimits(2);
    limits.upper << 0.5, 0.5;
    limits.lower = -limits.upper;
    limits.max_velocity.setConstant(2.0);
    limits.max_acceleration.setConstant(acceleration);
    JointVector q = JointVector::Zero(2);
    JointVector v = JointVector::Zero(2);
    for (int cycle = 0; cycle < 10000; ++cycle) {
      JointVector wanted = JointVector::Constant(2, 1.0);
      CommandLimiter(limits).apply(q, v, 0.001, wanted);
      v = wanted;
      q += 0.001 * v;
    }
    EXPECT_NEAR(q[0], 0.5, 1e-6) << acceleration;
    EXPECT_LT(std::abs(v[0]), 1e-3);
  }
}

TEST_F(CommandLimiterBraking, SlowsOnlyTheJointThatIsNearItsLimit) {
  JointLimits limits = test::noLimits(2);
  limits.upper[0] = 0.5;
  limits.max_acceleration.setConstant(10.0);
  JointVector q(2);
  q << 0.4999, 0.0;
  const JointVector before = (JointVector(2) << 0.0, 0.3).finished();
  JointVector v = before;
  v[0] = 0.0;
  JointVector wanted = (JointVector(2) << 1.0, 0.3).finished();
  CommandLimiter(limits).apply(q, v, 0.001, wanted);
  EXPECT_LT(wanted[0], 0.05);
  EXPECT_GT(wanted[1], 0.0) << "in contact the arm would freeze";
}

}  // namespace
}  // namespace tactus
