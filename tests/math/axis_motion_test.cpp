#include "tactus/math/axis_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "support/random.h"

namespace tactus {
namespace {

int motionRuns(int usual) {
  const char* const told = std::getenv("TACTUS_MOTION_RUNS");
  return told ? std::atoi(told) : usual;
}

MotionLimits randomMotionLimits(test::Random& random) {
  return {random.logUniform(0.1, 10.0), random.logUniform(0.1, 10.0),
          random.logUniform(1.0, 100.0)};
}

/// One that keeps the limits, and can go on keeping them.
AxisState randomAxisState(test::Random& random, const MotionLimits& limits) {
  AxisState state{random.uniform(-1.0, 1.0), 0.0, 0.0};
  const double a = random.uniform(-1.0, 1.0) * limits.max_acceleration;
  const double for_stop = a * a / (2.0 * limits.max_jerk);  // of speed, until a is zero
  if (random.chance(0.1) || for_stop > limits.max_speed) return state;
  state.a = a;
  state.v = random.uniform(-1.0, 1.0) * (limits.max_speed - for_stop);
  return state;
}

double randomTarget(test::Random& random, const AxisState& from) {
  return from.p + random.sign() * random.logUniform(1e-6, 100.0);
}

TEST(AxisMotion, KeepsItsLimitsAndComesToRestExactlyAtTheTarget) {
  test::Random random(3001);
  for (int run = 0; run < motionRuns(20000); ++run) {
    const MotionLimits limits = randomMotionLimits(random);
    const AxisState from = randomAxisState(random, limits);
    const double target = randomTarget(random, from);
    const AxisMotion motion(from, target, limits);
    const double T = motion.duration();
    for (int k = 0; k <= 40; ++k) {
      const AxisState state = motion.at(T * k / 40.0);
      ASSERT_LE(std::abs(state.v), limits.max_speed * (1.0 + 1e-9));
      ASSERT_LE(std::abs(state.a), limits.max_acceleration * (1.0 + 1e-9));
      ASSERT_LE(std::abs(motion.jerk(T * k / 40.0)), limits.max_jerk);
    }
    const AxisState before = motion.at(std::nextafter(T, 0.0)), end = motion.at(T);
    ASSERT_NEAR(before.p, target, 1e-9);
    ASSERT_NEAR(before.v, 0.0, 1e-9);
    ASSERT_NEAR(before.a, 0.0, 1e-7);  // of the jerk times what an ulp of T is
    ASSERT_EQ(end.p, target);
    ASSERT_EQ(end.v, 0.0);
    ASSERT_EQ(end.a, 0.0);
    ASSERT_EQ(motion.at(0.0).p, T > 0.0 ? from.p : target);
  }
}

TEST(AxisMotion, IsTheIntegralOfItsJerk) {
  test::Random random(3002);
  for (int run = 0; run < motionRuns(2000); ++run) {
    const MotionLimits limits = randomMotionLimits(random);
    const AxisState from = randomAxisState(random, limits);
    const AxisMotion motion(from, randomTarget(random, from), limits);
    const double t = random.uniform(0.0, motion.duration()), h = 1e-4;
    const AxisState at = motion.at(t), next = motion.at(t + h);
    // Of a step in which the jerk may change once.
    const double unsure = 2.0 * limits.max_jerk * h;
    ASSERT_NEAR(next.a, at.a + h * motion.jerk(t), unsure);
    ASSERT_NEAR(next.v, at.v + h * at.a, unsure * h);
    ASSERT_NEAR(next.p, at.p + h * (at.v + h * at.a / 2.0), unsure * h * h);
  }
}

/// What a fastest motion has to be, by Pontryagin's principle: at each moment one of its limits is
/// reached, and the jerk changes its sign no more often than 2 times between changes to V.
TEST(AxisMotion, IsAtALimitAllTheTime) {
  test::Random random(3003);
  for (int run = 0; run < motionRuns(5000); ++run) {
    const MotionLimits limits = randomMotionLimits(random);
    const AxisState from = randomAxisState(random, limits);
    const AxisMotion motion(from, randomTarget(random, from), limits);
    for (int k = 0; k < 40; ++k) {
      const double t = random.uniform(0.0, motion.duration() * 0.999);
      const AxisState state = motion.at(t);
      const bool is_limit = std::abs(motion.jerk(t)) == limits.max_jerk ||
                            std::abs(state.a) >= limits.max_acceleration * (1.0 - 1e-9) ||
                            std::abs(state.v) >= limits.max_speed * (1.0 - 1e-9);
      ASSERT_TRUE(is_limit) << t << " of " << motion.duration() << " s";
    }
  }
}

/// 1 m at 0.1 m/s, 0.5 m/s^2, 5 m/s^3: 0.1 s to full acceleration, 0.2 s at it... and back.
TEST(AxisMotion, IsAsComputedByHand) {
  const AxisMotion motion({0.0, 0.0, 0.0}, 1.0, {0.1, 0.5, 5.0});
  // V/A = 0.2 s and A/J = 0.1 s: speeds up for 0.3 s, on average at half of V, and so to rest.
  EXPECT_NEAR(motion.duration(), 1.0 / 0.1 + 0.3, 1e-12);
  EXPECT_NEAR(motion.at(0.1).a, 0.5, 1e-12);
  EXPECT_NEAR(motion.at(0.15).v, 0.05, 1e-12);
  EXPECT_NEAR(motion.at(0.3).p, 0.015, 1e-12);
  // So short that no limit but the jerk is reached: d = 2 J t^3 with four parts of t.
  const AxisMotion brief({0.0, 0.0, 0.0}, 2.0 * 5.0 * 1e-6, {0.1, 0.5, 5.0});
  EXPECT_NEAR(brief.duration(), 4.0 * 0.01, 1e-9);
}

TEST(AxisMotion, ComesBelowLimitsThatAreLessThanItsSpeed) {
  test::Random random(3004);
  for (int run = 0; run < motionRuns(5000); ++run) {
    const MotionLimits before = randomMotionLimits(random);
    const AxisState from = randomAxisState(random, before);
    const MotionLimits limits{before.max_speed * random.uniform(0.1, 1.0),
                              before.max_acceleration * random.uniform(0.1, 1.0), before.max_jerk};
    const double target = randomTarget(random, from);
    const AxisMotion motion(from, target, limits);
    const double for_a = from.a * from.a / (2.0 * limits.max_jerk);
    double a_before = std::abs(from.a);
    for (int k = 0; k <= 100; ++k) {
      const AxisState state = motion.at(motion.duration() * k / 100.0);
      ASSERT_LE(std::abs(state.v),
                std::max(limits.max_speed, std::abs(from.v) + for_a) * (1.0 + 1e-9));
      ASSERT_LE(std::abs(state.a), std::max(limits.max_acceleration, a_before) * (1.0 + 1e-9));
      a_before = std::abs(state.a);
    }
    ASSERT_EQ(motion.at(motion.duration()).p, target);
    ASSERT_NEAR(motion.at(std::nextafter(motion.duration(), 0.0)).p, target, 1e-9);
  }
}

TEST(AxisMotion, StopsTheFastestWay) {
  test::Random random(3005);
  for (int run = 0; run < motionRuns(5000); ++run) {
    const MotionLimits limits = randomMotionLimits(random);
    const AxisState from = randomAxisState(random, limits);
    const AxisMotion stop = AxisMotion::stop(from, limits);
    ASSERT_NEAR(stop.at(std::nextafter(stop.duration(), 0.0)).v, 0.0, 1e-9);
    // A way to another place takes longer.
    for (const double further : {-1e-3, 1e-3})
      ASSERT_GT(AxisMotion(from, stop.target() + further, limits).duration(), stop.duration());
    // To the same place it takes as long.
    ASSERT_NEAR(AxisMotion(from, stop.target(), limits).duration(), stop.duration(),
                1e-6 * (1.0 + stop.duration()));
  }
}

}  // namespace
}  // namespace tactus
