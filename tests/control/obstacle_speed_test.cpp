#include "tactus/control/obstacle_speed.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"

namespace tactus {
namespace {

const ForceGains kForceGains;  // F_act 3.8 N, F_th 1.2 N, T 0.1 s
constexpr double kForceSample_s = 0.004;
constexpr double kM_N_per_m = 5000.0;
constexpr double kComing_m_per_s = 0.006;
constexpr double kBound_m_per_s = 2.5 / (0.1 * kM_N_per_m);

/// The arm gives way at v_o under a force that stays, for so long.
void rest(double duration_s, const ObstacleSample& sample, ObstacleSpeedState& state) {
  state.F_before_N = sample.F_p_N;
  for (double t_s = 0.0; t_s < duration_s; t_s += kForceSample_s)
    followObstacle(kForceGains, sample, state);
}

ObstacleSample coming(double F_p_N) {
  return {F_p_N, kM_N_per_m, -kComing_m_per_s * kForceSample_s, kForceSample_s, true};
}

TEST(ObstacleSpeed, IsTheWayThatTheForceDoesNotExplain) {
  ObstacleSpeedState state;
  rest(0.29, coming(6.0), state);
  EXPECT_EQ(state.v_m_per_s, 0.0) << "on what stands still, too, the force takes its time";
  rest(5.0, coming(6.0), state);
  EXPECT_NEAR(state.v_m_per_s, kBound_m_per_s, 1e-15) << "2.5 N at most";
  ObstacleSample slow = coming(6.0);
  slow.dx_m *= 0.5;
  rest(5.0, slow, state);
  EXPECT_NEAR(state.v_m_per_s, 0.5 * kComing_m_per_s, 1e-6);
  rest(0.5, coming(4.1), state);
  EXPECT_NEAR(state.v_m_per_s, 0.5 * kComing_m_per_s, 1e-6) << "near enough: it stays";
  rest(0.5, coming(3.7), state);
  EXPECT_NEAR(state.v_m_per_s, 0.5 * kComing_m_per_s * std::exp(-1.0), 3e-5);
}

/// Of the limit of 5 N a tenth, which is more than noise.
TEST(ObstacleSpeed, IsLearntFromATenthOfTheLimitAboveTheActivationForce) {
  for (const double F_p_N : {3.8 + 0.49, 3.8 + 0.51}) {
    ObstacleSpeedState state;
    rest(1.0, coming(F_p_N), state);
    EXPECT_EQ(state.v_m_per_s > 0.0, F_p_N > 4.3);
  }
}

/// Where each of its conditions begins, of numbers that are exact.
TEST(ObstacleSpeed, BeginsAboveItsLimitsAndNotAtThem) {
  ForceGains gains;
  gains.activation_force_N = 2.0;
  gains.contact_threshold_N = 8.0;
  gains.time_constant_s = 1.0;
  const auto learnt = [&](double F_p_N, double m_N_per_m, int samples) {
    ObstacleSpeedState state;
    state.F_before_N = F_p_N;
    for (int i = 0; i < samples; ++i)
      followObstacle(gains, {F_p_N, m_N_per_m, -1e-4, 1.0, true}, state);
    return state.v_m_per_s;
  };
  EXPECT_EQ(learnt(3.0, 1000.0, 9), 0.0) << "1 N is a tenth of 10 N";
  EXPECT_GT(learnt(3.0625, 1000.0, 9), 0.0);
  EXPECT_EQ(learnt(4.0, 1000.0, 3), 0.0) << "3 T";
  EXPECT_GT(learnt(4.0, 1000.0, 4), 0.0);
  EXPECT_GT(learnt(4.0, kSoftContact_N_per_m, 9), 0.0);
  EXPECT_EQ(learnt(4.0, 1.001 * kSoftContact_N_per_m, 9), 0.0);
  ObstacleSpeedState state;
  state.v_m_per_s = 1e-4;
  followObstacle(gains, {2.0, 1000.0, 0.0, 1.0, true}, state);
  EXPECT_EQ(state.v_m_per_s, 1e-4) << "at the activation force it stays";
}

TEST(ObstacleSpeed, TakesTheChangeOfForceForAWayToo) {
  // The arm stands still, and the force rises by 1 mm/s.
  ObstacleSpeedState state;
  ObstacleSample sample{5.0, kM_N_per_m, 0.0, kForceSample_s, true};
  state.F_before_N = sample.F_p_N;
  for (int i = 0; i < 1000; ++i) {
    sample.F_p_N += kM_N_per_m * 0.001 * kForceSample_s;
    followObstacle(kForceGains, sample, state);
  }
  EXPECT_NEAR(state.v_m_per_s, 0.001, 1e-6);
}

TEST(ObstacleSpeed, IsNothingWhereTheLimitDoesNotHoldTheArm) {
  ObstacleSpeedState state;
  ObstacleSample sample = coming(6.0);
  sample.is_limiting = false;
  rest(5.0, sample, state);
  EXPECT_EQ(state.v_m_per_s, 0.0);
}

TEST(ObstacleSpeed, IsDroppedWithItsPastOnAStiffContact) {
  ObstacleSpeedState state;
  rest(5.0, coming(6.0), state);
  ASSERT_GT(state.v_m_per_s, 0.0);
  ObstacleSample sample = coming(6.0);
  sample.m_N_per_m = 1.01 * kSoftContact_N_per_m;
  followObstacle(kForceGains, sample, state);
  EXPECT_EQ(state.v_m_per_s, 0.0);
}

TEST(ObstacleSpeed, CostsNoMoreThanHalfOfTheLimitWhateverComes) {
  test::Random random(1701);
  ObstacleSpeedState state;
  int known = 0;
  for (int i = 0; i < 100000; ++i) {
    const ObstacleSample sample{random.chance(0.02) ? 2.0 : random.logUniform(4.4, 100.0),
                                random.logUniform(10.0, 1e6),
                                random.sign() * random.logUniform(1e-9, 1.0),
                                random.logUniform(1e-4, 0.1), random.chance(0.99)};
    followObstacle(kForceGains, sample, state);
    ASSERT_GE(state.v_m_per_s, 0.0);
    ASSERT_LE(state.v_m_per_s * 0.1 * sample.m_N_per_m, 2.5 * (1.0 + 1e-12));
    known += state.v_m_per_s > 0.0;
  }
  EXPECT_GT(known, 1000);
}

}  // namespace
}  // namespace tactus
