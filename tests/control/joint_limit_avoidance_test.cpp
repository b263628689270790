#include "tactus/control/joint_limit_avoidance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_robot.h"

namespace tactus {
namespace {

struct CostCase {
  explicit CostCase(test::Random& random) : n(random.integer(2, kMaxJoints)) {
    limits = test::noLimits(n);
    limits.lower = random.vector(n, -3.0, 0.0);
    limits.upper = limits.lower + random.vector(n, 0.1, 4.0);
    gains.gain = random.uniform(0.1, 2.0);
    gains.gradient_at_limit = random.uniform(0.5, 5.0);
    gains.active_fraction = random.uniform(0.05, 1.0);
    q = limits.lower + (limits.upper - limits.lower).cwiseProduct(random.vector(n, 0.0, 1.0));
  }

  /// H: a parabola over the outer part of each half range; its slope at the limit is given.
  double cost(const JointVector& at) const {
    double H = 0.0;
    for (int i = 0; i < n; ++i) {
      const double half = 0.5 * (limits.upper[i] - limits.lower[i]);
      const double offset = std::abs(at[i] - 0.5 * (limits.upper[i] + limits.lower[i]));
      const double width = gains.active_fraction * half;
      const double s = std::max(0.0, (offset - (half - width)) / width);
      H += 0.5 * gains.gradient_at_limit * width * s * s;
    }
    return H;
  }

  int n;
  JointLimits limits;
  JointLimitAvoidanceGains gains;
  JointVector q;
};

TEST(JointLimitAvoidance, IsTheGradientOfACost) {
  test::Random random(151);
  for (int i = 0; i < 500; ++i) {
    const CostCase c(random);
    const ScaledVector inv_sqrt_weights = random.vector(kMaxJoints, 0.1, 3.0);
    const JointLimitAvoidance avoidance(c.limits, inv_sqrt_weights);
    const JointLimitCost evaluated = avoidance.evaluate(avoidance.zones(c.gains), c.q);
    const ScaledVector gradient = evaluated.gradient.cwiseQuotient(inv_sqrt_weights);
    ASSERT_EQ(gradient.tail(kMaxJoints - c.n).norm(), 0.0);
    ASSERT_NEAR(evaluated.nearness,
                gradient.lpNorm<Eigen::Infinity>() / (c.gains.gain * c.gains.gradient_at_limit),
                1e-12);
    const double h = 1e-6;
    for (int k = 0; k < c.n; ++k) {
      const JointVector step = h * JointVector::Unit(c.n, k);
      const double slope = (c.cost(c.q + step) - c.cost(c.q - step)) / (2.0 * h);
      // The slope has a kink where the zone begins: an error of a step there.
      const double width = 0.5 * c.gains.active_fraction * (c.limits.upper - c.limits.lower)[k];
      const double kink = c.gains.gradient_at_limit * h / width;
      ASSERT_NEAR(gradient[k], c.gains.gain * slope, c.gains.gain * (kink + 1e-7)) << i;
    }
  }
}

TEST(JointLimitAvoidance, GrowsTowardsTheNearerLimitOnly) {
  JointLimits limits = test::noLimits(2);
  limits.lower << -1.0, -2.0;
  limits.upper << 3.0, 2.0;
  const JointLimitAvoidance avoidance(limits, ScaledVector::Ones());
  const JointLimitZones zones = avoidance.zones({1.0, 3.52, 0.5});
  ScaledVector gradient;
  const auto at = [&](double q0, double q1) {
    gradient = avoidance.evaluate(zones, JointVector(Eigen::Vector2d(q0, q1))).gradient;
    return gradient;
  };
  EXPECT_EQ(at(1.0, 0.0).norm(), 0.0) << "in the middle";
  EXPECT_EQ(at(1.99, -0.99).norm(), 0.0) << "in the inner half";
  EXPECT_NEAR(at(3.0, -2.0)[0], 3.52, 1e-12);
  EXPECT_NEAR(gradient[1], -3.52, 1e-12);
  EXPECT_NEAR(at(2.5, 0.0)[0], 1.76, 1e-12);
}

TEST(JointLimitAvoidance, IsNoNearerThanTheLimitBeyondIt) {
  JointLimits limits = test::noLimits(1);
  limits.lower[0] = -1.0;
  limits.upper[0] = 1.0;
  const JointLimitAvoidance avoidance(limits, ScaledVector::Ones());
  for (const double q : {1.0, 1.3, -1.3})
    EXPECT_EQ(avoidance.evaluate(avoidance.zones({}), JointVector::Constant(1, q)).nearness, 1.0);
}

TEST(JointLimitAvoidance, IgnoresJointsWithoutLimits) {
  JointLimits limits = test::noLimits(3);
  limits.lower[1] = -1.0;  // one side alone has no middle
  const JointLimitAvoidance avoidance(limits, ScaledVector::Ones());
  const JointLimitCost cost =
      avoidance.evaluate(avoidance.zones({}), JointVector(Eigen::Vector3d(1e6, -0.99, -1e300)));
  EXPECT_EQ(cost.gradient.norm(), 0.0);
  EXPECT_EQ(cost.nearness, 0.0);
}

}  // namespace
}  // namespace tactus
