#include "tactus/commission/stroke_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"
#include "tactus/commission/stroke_figures.h"

namespace tactus {
namespace {

constexpr double kStrokeStep_s = 0.001;

struct DrawnStroke {
  MotionLimits limits;
  StrokeShape shape;
};

DrawnStroke drawStroke(test::Random& random) {
  DrawnStroke drawn;
  drawn.limits.max_speed = random.logUniform(1e-3, 0.1);
  drawn.limits.max_acceleration = random.logUniform(0.05, 1.0);
  drawn.limits.max_jerk = 10.0 * drawn.limits.max_acceleration;
  drawn.shape.kind = random.chance(0.5) ? StrokeShape::Kind::kStep : StrokeShape::Kind::kWave;
  drawn.shape.distance = random.sign() * random.logUniform(1e-3, 0.1);
  return drawn;
}

TEST(StrokeMotion, StaysWithinBoundsAndEndsAtRest) {
  test::Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    const DrawnStroke drawn = drawStroke(random);
    const StrokeMotion motion(drawn.shape, drawn.limits);
    const bool is_wave = drawn.shape.kind == StrokeShape::Kind::kWave;
    double before = 0.0, farthest = 0.0, fastest = 0.0;
    for (double t = 0.0; t < motion.duration() + 0.01; t += kStrokeStep_s) {
      const AxisState state = motion.at(t);
      const double along = state.p / drawn.shape.distance;
      ASSERT_GE(along, -1e-9);
      ASSERT_LE(along, 1.0 + 1e-9);
      ASSERT_LE(std::abs(state.v), drawn.limits.max_speed * (1.0 + 1e-9));
      ASSERT_LE(std::abs(state.a), drawn.limits.max_acceleration * (1.0 + 1e-9));
      // What is sent, the way of a cycle, is the speed that is told.
      ASSERT_NEAR(state.p - before, kStrokeStep_s * state.v,
                  kStrokeStep_s * kStrokeStep_s * drawn.limits.max_acceleration + 1e-12);
      before = state.p;
      farthest = std::max(farthest, along);
      fastest = std::max(fastest, std::abs(state.v));
    }
    const AxisState end = motion.at(motion.duration());
    EXPECT_DOUBLE_EQ(end.p, is_wave ? 0.0 : drawn.shape.distance);
    EXPECT_EQ(end.v, 0.0);
    EXPECT_GT(farthest, 0.95);
    EXPECT_GT(fastest, is_wave ? 0.3 * std::min(drawn.limits.max_speed, 1e-3) : 0.0);
  }
}

TEST(StrokeMotion, StopsFromAnywhereWithoutAJump) {
  test::Random random(12);
  for (int trial = 0; trial < 200; ++trial) {
    const DrawnStroke drawn = drawStroke(random);
    StrokeMotion motion(drawn.shape, drawn.limits);
    const AxisState at = motion.at(random.uniform(0.0, motion.duration()));
    motion.stopFrom({0.0, at.v, at.a}, drawn.limits);
    EXPECT_DOUBLE_EQ(motion.at(0.0).v, at.v);
    EXPECT_EQ(motion.at(motion.duration()).v, 0.0);
    const double ramp_s = drawn.limits.max_speed / drawn.limits.max_acceleration + 0.2;
    EXPECT_LT(motion.duration(), ramp_s);
    EXPECT_LT(std::abs(motion.at(motion.duration()).p), drawn.limits.max_speed * ramp_s);
  }
}

TEST(StrokeFigures, LagAndAccelerationOfADriveThatFollowsLate) {
  for (const double lag_s : {0.0, 0.004, 0.02}) {
    const MotionLimits limits{0.05, 0.5, 5.0};
    const StrokeMotion step({StrokeShape::Kind::kStep, 0.1}, limits);
    const StrokeMotion wave({StrokeShape::Kind::kWave, 0.05}, limits);
    StrokeFigures of_step(kStrokeStep_s), of_wave(kStrokeStep_s);
    double fastest = 0.0;
    for (double t = 0.0; t < wave.duration(); t += kStrokeStep_s) {
      fastest = std::max(fastest, std::abs(wave.at(t).v));
      const double late = std::max(0.0, t - lag_s);
      of_wave.add(wave.at(t).p, wave.at(t).v, wave.at(late).p);
      of_step.add(step.at(t).p, step.at(t).v, step.at(late).p);
    }
    EXPECT_NEAR(of_wave.values().lag_s, lag_s, 1e-4);
    EXPECT_NEAR(of_wave.values().largest_error, fastest * lag_s, 0.01 * fastest * lag_s + 1e-12);
    EXPECT_NEAR(of_step.values().largest_acceleration, 0.5, 0.05);
  }
}

}  // namespace
}  // namespace tactus
