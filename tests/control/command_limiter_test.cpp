#include "tactus/control/command_limiter.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>

#include "support/random_limits.h"

/// Single cycles of the last gate, without position limits in the way.
namespace tactus {
namespace {

struct LimiterCase {
  explicit LimiterCase(test::Random& random)
      : n(random.integer(1, kMaxJoints)),
        limits(test::randomLimits(random, n)),
        q(JointVector::Zero(n)),
        before(n),
        period_s(random.logUniform(2e-4, 0.01)) {
    limits.lower.setConstant(-kNoLimit);
    limits.upper.setConstant(kNoLimit);
    for (int i = 0; i < n; ++i) {
      const double range = std::min(limits.max_velocity[i], 20.0);
      before[i] = random.chance(0.3) ? 0.0 : random.uniform(-range, range);
    }
  }

  double low(int i) const {
    return std::max(-limits.max_velocity[i], before[i] - limits.max_acceleration[i] * period_s);
  }
  double high(int i) const {
    return std::min(limits.max_velocity[i], before[i] + limits.max_acceleration[i] * period_s);
  }
  bool admissible(const JointVector& v, double tolerance) const {
    for (int i = 0; i < n; ++i)
      if (!(v[i] >= low(i) - tolerance && v[i] <= high(i) + tolerance)) return false;
    return true;
  }

  int n;
  JointLimits limits;
  JointVector q, before;
  double period_s;
};

TEST(CommandLimiter, LeavesAdmissibleCommandsAloneToTheBit) {
  test::Random random(161);
  for (int i = 0; i < 5000; ++i) {
    const LimiterCase c(random);
    JointVector wanted(c.n);
    for (int k = 0; k < c.n; ++k)
      wanted[k] = random.uniform(std::max(-100.0, c.low(k)), std::min(100.0, c.high(k)));
    JointVector v = wanted;
    ASSERT_TRUE(CommandLimiter(c.limits).apply(c.q, c.before, c.period_s, v));
    ASSERT_EQ(v, wanted) << "case " << i;
  }
}

TEST(CommandLimiter, AdmitsAtAGlanceOnlyWhatItLeavesAlone) {
  test::Random random(165);
  const double odd[] = {std::numeric_limits<double>::quiet_NaN(), kNoLimit, -kNoLimit, -0.0};
  int admitted = 0;
  for (int i = 0; i < 50000; ++i) {
    LimiterCase c(random);
    JointVector wanted(c.n);
    for (int k = 0; k < c.n; ++k) {
      c.limits.lower[k] = random.chance(0.3) ? -kNoLimit : -random.logUniform(1e-3, 1e5);
      c.limits.upper[k] = random.chance(0.3) ? kNoLimit : random.logUniform(1e-3, 1e5);
      wanted[k] = random.uniform(std::max(-100.0, c.low(k)), std::min(100.0, c.high(k)));
    }
    if (random.chance(0.5)) wanted[random.integer(0, c.n - 1)] = odd[random.integer(0, 3)];
    const CommandLimiter limiter(c.limits);
    if (!limiter.admits(c.q, c.before, c.period_s, wanted)) continue;
    ++admitted;
    JointVector v = wanted;
    ASSERT_TRUE(limiter.apply(c.q, c.before, c.period_s, v));
    for (int k = 0; k < c.n; ++k)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(v[k]), std::bit_cast<std::uint64_t>(wanted[k]));
  }
  EXPECT_GT(admitted, 1000);
}

TEST(CommandLimiter, LetsNothingInadmissibleThrough) {
  test::Random random(162);
  for (int i = 0; i < 50000; ++i) {
    const LimiterCase c(random);
    JointVector v(c.n);
    const bool hostile = random.chance(0.5);
    for (double& value : v)
      value = hostile ? test::hostileNumber(random) : random.uniform(-20.0, 20.0);
    const bool finite = v.allFinite();
    const double largest = v.lpNorm<Eigen::Infinity>();
    const bool said_finite = CommandLimiter(c.limits).apply(c.q, c.before, c.period_s, v);
    ASSERT_TRUE(v.allFinite());
    ASSERT_TRUE(c.admissible(v, 1e-14)) << "case " << i;
    if (!finite) {
      ASSERT_FALSE(said_finite);
    } else if (largest < 1e300) {
      ASSERT_TRUE(said_finite);
    }
  }
}

TEST(CommandLimiter, RampsToRestOnNoNumber) {
  test::Random random(163);
  for (int i = 0; i < 1000; ++i) {
    const LimiterCase c(random);
    JointVector v = JointVector::Ones(c.n);
    v[random.index(c.n)] = std::numeric_limits<double>::quiet_NaN();
    ASSERT_FALSE(CommandLimiter(c.limits).apply(c.q, c.before, c.period_s, v));
    for (int k = 0; k < c.n; ++k) {
      const double step = c.limits.max_acceleration[k] * c.period_s;
      const double expected =
          c.before[k] > 0.0 ? std::max(0.0, c.before[k] - step) : std::min(0.0, c.before[k] + step);
      ASSERT_NEAR(v[k], expected, 1e-14);
    }
  }
}

/// Brute force: is any factor of 0..1 admissible, and which is the largest?
double largestAdmissibleFactor(const LimiterCase& c, const JointVector& wanted, double tolerance) {
  for (int step = 20000; step >= 0; --step) {
    const double factor = step / 20000.0;
    if (c.admissible(factor * wanted, tolerance)) return factor;
  }
  return -1.0;
}

TEST(CommandLimiter, KeepsTheDirectionWhereverAMultipleIsAdmissible) {
  test::Random random(164);
  int shortened = 0;
  int clamped = 0;
  for (int i = 0; i < 1500; ++i) {
    LimiterCase c(random);
    // Long enough steps that previous speeds and the command often have multiples in common.
    c.before *= random.logUniform(1e-4, 1.0);
    const JointVector wanted = random.vector(c.n, -1.0, 1.0) * random.logUniform(0.01, 100.0);
    JointVector v = wanted;
    CommandLimiter(c.limits).apply(c.q, c.before, c.period_s, v);
    const double factor = largestAdmissibleFactor(c, wanted, 0.0);
    if (factor < 0.0) {
      ++clamped;
      continue;
    }
    const double ours = v.dot(wanted) / wanted.squaredNorm();
    ASSERT_LT((v - ours * wanted).norm(), 1e-12 * wanted.norm()) << "direction lost, case " << i;
    ASSERT_GE(ours, factor - 1e-12) << "shortened more than necessary";
    ASSERT_LE(ours, 1.0 + 1e-15);
    shortened += factor < 1.0;
  }
  EXPECT_GT(shortened, 300);
  EXPECT_GT(clamped, 100);
}

TEST(CommandLimiter, ComesAsCloseAsItCanWhereNoMultipleIsAdmissible) {
  JointLimits limits = test::noLimits(2);
  limits.max_acceleration << 10.0, 10.0;
  const JointVector before = JointVector::Ones(2);
  JointVector v(2);
  v << 1.0, -1.0;  // the second joint needs time to turn round
  CommandLimiter(limits).apply(JointVector::Zero(2), before, 0.01, v);
  EXPECT_DOUBLE_EQ(v[0], 1.0);
  EXPECT_DOUBLE_EQ(v[1], 0.9);
}

/// Three joints, of which two say by how much all are scaled.
struct ScaledCommand {
  const char* what;
  Vector3 wanted, before, max_velocity, change, expected;
};

TEST(CommandLimiter, ScalesAllJointsByWhatOneOfThemNeeds) {
  constexpr double kExact_s = 1.0 / 1024.0;  // so that limits are met to the bit
  constexpr double kFree = 100.0;
  const Vector3 free(kFree, kFree, kFree);
  const ScaledCommand cases[] = {{"a joint at rest needs nothing",
                                  {1.0, 0.4, 0.0},
                                  {0.0, 0.0, 0.0},
                                  {0.5, kFree, 0.75},
                                  free,
                                  {0.5, 0.2, 0.0}},
                                 {"nor does one that can only just rest",
                                  {1.0, 0.4, 0.0},
                                  {0.0, 0.0, -0.25},
                                  {0.5, kFree, kFree},
                                  {kFree, kFree, 0.25},
                                  {0.5, 0.2, 0.0}},
                                 {"whichever way it goes",
                                  {1.0, 0.4, 0.0},
                                  {0.0, 0.0, 0.25},
                                  {0.5, kFree, kFree},
                                  {kFree, kFree, 0.25},
                                  {0.5, 0.2, 0.0}},
                                 {"there is but one factor",
                                  {1.0, 1.0, 0.4},
                                  {0.75, 0.0, 0.0},
                                  {kFree, 0.5, kFree},
                                  {0.25, kFree, kFree},
                                  {0.5, 0.5, 0.2}},
                                 {"no factor does for two of them: each by itself",
                                  {1.0, 0.5, 0.4},
                                  {1.25, 0.0, 0.0},
                                  {kFree, 0.25, kFree},
                                  {0.25, kFree, kFree},
                                  {1.0, 0.25, 0.2}},
                                 {"nor does one for a joint that cannot rest yet",
                                  {0.0, 0.5, 0.4},
                                  {1.0, 0.5, 0.4},
                                  free,
                                  {0.25, kFree, kFree},
                                  {0.75, 0.5, 0.4}},
                                 {"nor for that, beside one that is too fast",
                                  {0.0, 0.5, 0.4},
                                  {1.0, 0.5, 0.4},
                                  {kFree, 0.25, kFree},
                                  {0.25, kFree, kFree},
                                  {0.75, 0.25, 0.2}}};
  for (const ScaledCommand& c : cases) {
    JointLimits limits;
    limits.lower = JointVector::Constant(3, -kNoLimit);
    limits.upper = JointVector::Constant(3, kNoLimit);
    limits.max_velocity = c.max_velocity;
    limits.max_acceleration = c.change / kExact_s;
    JointVector v = c.wanted;
    ASSERT_TRUE(CommandLimiter(limits).apply(JointVector::Zero(3), c.before, kExact_s, v));
    EXPECT_LT((v - JointVector(c.expected)).cwiseAbs().maxCoeff(), 1e-15)
        << c.what << ": " << v.transpose();
  }
}

/// One that has lost it to a slow joint, whose ramp is slow, too, as that of a lift before an arm.
TEST(CommandLimiter, FindsTheDirectionAgainWhileTheCommandIsTooFast) {
  JointLimits limits = test::noLimits(2);
  limits.max_velocity << 0.035, 2.5;
  limits.max_acceleration << 0.17, 12.0;
  const CommandLimiter limiter(limits);
  const JointVector wanted{{-0.1, -0.3}};
  JointVector v{{0.0, -0.3}};                  // so far it was for the second joint alone
  for (int cycle = 0; cycle < 210; ++cycle) {  // 0.035 / 0.17 s
    const JointVector before = v;
    v = wanted;
    ASSERT_TRUE(limiter.apply(JointVector::Zero(2), before, 0.001, v));
    ASSERT_LE(v[0], before[0]) << "towards what is wanted";
  }
  EXPECT_NEAR(v[0], -0.035, 1e-12);
  EXPECT_NEAR(v[1], -0.105, 1e-12);
}

/// Whichever joint it is, and whatever limits it.
TEST(CommandLimiter, AdmitsAtAGlanceNoJointThatItWouldLimit) {
  constexpr double kGlance_s = 0.001;
  for (int n = 2; n <= kMaxJoints; ++n) {
    const JointVector none = JointVector::Constant(n, kNoLimit);
    const JointLimits unlimited{-none, none, none, none};
    const JointVector v = JointVector::Ones(n);
    EXPECT_TRUE(CommandLimiter(unlimited).admits(0.0 * v, v, kGlance_s, v)) << n;
    for (int k = 0; k < n; ++k) {
      for (const double place : {-1.0, 0.0, 1.0}) {
        const JointVector q = place * v;
        JointLimits slow = unlimited, lazy = unlimited, near = unlimited, other_way = unlimited;
        slow.max_velocity[k] = 0.5;
        EXPECT_FALSE(CommandLimiter(slow).admits(q, v, kGlance_s, v)) << n << " " << k;
        lazy.max_acceleration[k] = 100.0;
        JointVector before = v;
        before[k] = 0.5;
        EXPECT_FALSE(CommandLimiter(lazy).admits(q, before, kGlance_s, v)) << n << " " << k;
        near.max_acceleration[k] = other_way.max_acceleration[k] = 10.0;
        near.upper[k] = place + 0.01;
        EXPECT_FALSE(CommandLimiter(near).admits(q, v, kGlance_s, v)) << n << " " << k;
        other_way.lower[k] = place - 0.01;
        EXPECT_FALSE(CommandLimiter(other_way).admits(q, -v, kGlance_s, -v)) << n << " " << k;
      }
    }
  }
}

/// Braking from v takes v dt / 2 + v^2 / (2 a) + a dt^2 / 8, and no more is kept clear.
TEST(CommandLimiter, BrakesNoEarlierThanItHasTo) {
  test::Random random(166);
  for (int i = 0; i < 1000; ++i) {
    const double a = random.logUniform(0.1, 100.0), dt = random.logUniform(1e-4, 1e-2);
    const double v = a * dt * random.logUniform(1.1, 1e3);
    JointLimits limits;
    limits.lower = JointVector::Constant(1, -kNoLimit);
    limits.upper = JointVector::Constant(1, 0.5 * v * dt + 0.5 * v * v / a + a * dt * dt / 8.0);
    limits.max_velocity = JointVector::Constant(1, kNoLimit);
    limits.max_acceleration = JointVector::Constant(1, a);
    JointVector faster = JointVector::Constant(1, v + 0.5 * a * dt);
    ASSERT_TRUE(CommandLimiter(limits).apply(JointVector::Zero(1), JointVector::Constant(1, v), dt,
                                             faster));
    ASSERT_NEAR(faster[0], v, 1e-12 * v) << i;
  }
}

}  // namespace
}  // namespace tactus
