#include "tactus/record/touch_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <random>

#include "support/rail_robot.h"
#include "support/random.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

constexpr double kFitCycle_s = 0.001;
constexpr double kFelt_N = 1.2;
constexpr int kSampleCycles = 4;

/// A carriage that runs into a spring at 1 s, and is stopped and let back by it as in a contact.
struct SpringTouch {
  double stiffness_N_per_m = 2000.0;
  double speed_m_per_s = 0.03;
  double noise_N = 0.0;
  double position_m = 0.5;
  double noise_across_N = 0.0;  ///< to both sides of the force, and along it
};

ControllerConfig fitConfig() {
  ControllerConfig config = test::railController(Variant::kNullSpace);
  config.gains.force.contact_threshold_N = kFelt_N;
  return config;
}

struct FitRun {
  std::deque<TouchSample> samples;
  double felt_s = 0.0;
};

/// The way eases out to 1.5 to 6 N behind the touch, and then swings a little.
FitRun touchRun(const SpringTouch& touch, std::uint64_t seed) {
  test::Random random(seed);
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  const double deepest_m = random.uniform(2.0, 6.0) / touch.stiffness_N_per_m;
  const double phase = random.uniform(0.0, 6.0);
  ButterworthLowPass filter(15.0, 1.0 / kFitCycle_s);
  FitRun run;
  double held_N = 0.0;
  Vector3 held = Vector3::Zero();
  std::uint64_t sequence = 0;
  for (int i = 0; i < 3500; ++i) {
    const double t_s = kFitCycle_s * i - 1.0;
    double way_m = touch.speed_m_per_s * t_s;
    if (t_s > 0.0)
      way_m = deepest_m * (1.0 - std::exp(-touch.speed_m_per_s * t_s / deepest_m)) +
              0.1 * deepest_m * std::sin(9.0 * t_s + phase) * (1.0 - std::exp(-5.0 * t_s));
    const double filtered_N = filter.update(touch.stiffness_N_per_m * std::max(0.0, way_m));
    if (i % kSampleCycles == 0) {
      held_N = std::abs(filtered_N + touch.noise_N * noise(engine));
      ++sequence;
    }
    TouchSample sample{.t_s = kFitCycle_s * i, .force_N = held_N, .position_m = touch.position_m};
    sample.direction = held_N > 0.05 ? Vector3(-Vector3::UnitY()) : Vector3(Vector3::Zero());
    if (touch.noise_across_N > 0.0) {
      if (i % kSampleCycles == 0)
        held = Vector3(0.0, -filtered_N + touch.noise_across_N * noise(engine),
                       touch.noise_across_N * noise(engine));
      held_N = sample.force_N = held.norm();
      sample.way = held;
      sample.direction = held / held_N;
    }
    sample.sequence = sequence;
    sample.q[0] = way_m;
    run.samples.push_back(sample);
    if (held_N > kFelt_N && run.felt_s == 0.0) run.felt_s = sample.t_s;
  }
  return run;
}

TouchFit fitOf(const SpringTouch& touch, std::uint64_t seed) {
  const FitRun run = touchRun(touch, seed);
  EXPECT_GT(run.felt_s, 0.0);
  return fitTouch(fitConfig(), 0, run.samples, run.felt_s);
}

TEST(TouchFit, FindsStiffnessPlaceAndSpeedOfAnySpring) {
  test::Random random(3);
  for (int i = 0; i < 100; ++i) {
    SpringTouch touch{.stiffness_N_per_m = random.logUniform(50.0, 2e4),
                      .speed_m_per_s = random.logUniform(0.01, 0.3)};
    const TouchFit fit = fitOf(touch, static_cast<std::uint64_t>(i));
    ASSERT_TRUE(fit.is_known);
    EXPECT_NEAR(fit.stiffness_N_per_m, touch.stiffness_N_per_m, 0.005 * touch.stiffness_N_per_m);
    EXPECT_LE(fit.low_N_per_m, fit.stiffness_N_per_m);
    EXPECT_GE(fit.high_N_per_m, fit.stiffness_N_per_m);
    if (fit.touch_s > 1.02) continue;  // a soft one touches before the samples begin
    EXPECT_NEAR(fit.speed_m_per_s, touch.speed_m_per_s, 0.05 * touch.speed_m_per_s);
  }
}

/// Of an interval of 95 % at least nine of ten have the stiffness in it, and it is no excuse.
TEST(TouchFit, HasTheStiffnessInItsIntervalWhereTheSensorIsNoisy) {
  test::Random random(4);
  int inside = 0, known = 0;
  double width = 0.0;
  for (int i = 0; i < 200; ++i) {
    SpringTouch touch{.stiffness_N_per_m = random.logUniform(50.0, 2e4),
                      .speed_m_per_s = random.logUniform(0.01, 0.2),
                      .noise_N = 0.05};
    const TouchFit fit = fitOf(touch, static_cast<std::uint64_t>(1000 + i));
    if (!fit.is_known) continue;
    ++known;
    width += (fit.high_N_per_m - fit.low_N_per_m) / touch.stiffness_N_per_m;
    inside +=
        fit.low_N_per_m <= touch.stiffness_N_per_m && touch.stiffness_N_per_m <= fit.high_N_per_m
            ? 1
            : 0;
  }
  EXPECT_GT(known, 190);
  EXPECT_GT(inside, 0.9 * known);
  EXPECT_LT(width / known, 0.3);
}

/// A size is no less than 0: taken for a force along F^, noise before the touch would be one, and
/// the contact 6 % softer in the mean than it is.
TEST(TouchFit, TakesNoNoiseOfAFreeModuleForAForce) {
  double sum = 0.0;
  int known = 0;
  for (int i = 0; i < 200; ++i) {
    const SpringTouch touch{
        .stiffness_N_per_m = 300.0, .speed_m_per_s = 0.015, .noise_across_N = 0.2};
    const TouchFit fit = fitOf(touch, static_cast<std::uint64_t>(3000 + i));
    if (!fit.is_known) continue;
    ++known;
    sum += fit.stiffness_N_per_m / touch.stiffness_N_per_m;
  }
  EXPECT_GT(known, 190);
  EXPECT_NEAR(sum / known, 1.0, 0.02);
}

TEST(TouchFit, KnowsWhereASmallForcePointsByItsOwnSample) {
  CycleRecord record;
  record.contact_dir_y[1] = 1.0;
  const auto wayOf = [&record](double sensor_N, double y_N, double z_N) {
    record.force_sensor_N[1] = sensor_N;
    record.tactile_force_y_N[1] = y_N;
    record.tactile_force_z_N[1] = z_N;
    return touchSample(record, 1).way;
  };
  EXPECT_EQ(wayOf(2.0, -2.0, 0.0), Vector3::UnitY());
  EXPECT_EQ(wayOf(0.04, -0.04, 0.0), Vector3(0.0, -0.04, 0.0));  // F^ is of an earlier sample
  EXPECT_EQ(wayOf(0.04, -1.0, 3.0), Vector3::Zero());            // with the weight of a cover
  EXPECT_EQ(wayOf(0.0, 0.0, 0.0), Vector3::Zero());
}

/// By one that was touched long before F_th is passed, as where the threshold is large: no place of
/// touch is in the samples, nor near them.
TEST(TouchFit, FindsTheStiffnessOfWhatWasTouchedLongBefore) {
  for (const double stiffness_N_per_m : {20.0, 200.0, 2000.0}) {
    const SpringTouch touch{.stiffness_N_per_m = stiffness_N_per_m,
                            .speed_m_per_s = 20.0 / stiffness_N_per_m};
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const FitRun run = touchRun(touch, seed);
      const double felt_s = 2.9;
      const TouchFit fit = fitTouch(fitConfig(), 0, run.samples, felt_s);
      ASSERT_TRUE(fit.is_known) << seed;
      EXPECT_NEAR(fit.stiffness_N_per_m, stiffness_N_per_m, 0.005 * stiffness_N_per_m) << seed;
    }
  }
}

/// F_sen is a size, and the filter swings back behind each push: taken for one from the other side,
/// a way out of the obstacle would be one into it.
TEST(TouchFit, FindsTheStiffnessOfAContactThatBounces) {
  test::Random random(6);
  for (int i = 0; i < 50; ++i) {
    const double stiffness_N_per_m = random.logUniform(100.0, 1e4);
    const double turn_per_s = 2.0 * std::numbers::pi * random.uniform(4.0, 8.0);
    const double deepest_m = random.uniform(5.0, 15.0) / stiffness_N_per_m;
    ButterworthLowPass filter(15.0, 1.0 / kFitCycle_s);
    FitRun run;
    TouchSample sample{.position_m = 0.5};
    for (int k = 0; k < 2500; ++k) {
      sample.t_s = kFitCycle_s * k;
      const double angle = turn_per_s * (sample.t_s - 1.0);
      sample.q[0] = deepest_m * (angle < 0.0 ? angle : std::sin(angle));
      const double filtered_N = filter.update(stiffness_N_per_m * std::max(0.0, sample.q[0]));
      if (k % kSampleCycles == 0) {
        sample.force_N = std::abs(filtered_N);
        sample.way = Vector3(0.0, -filtered_N, 0.0);
        if (sample.force_N > 0.05) sample.direction = sample.way.normalized();
        ++sample.sequence;
      }
      run.samples.push_back(sample);
      if (sample.force_N > kFelt_N && run.felt_s == 0.0) run.felt_s = sample.t_s;
    }
    const TouchFit fit = fitTouch(fitConfig(), 0, run.samples, run.felt_s);
    ASSERT_TRUE(fit.is_known) << i;
    EXPECT_NEAR(fit.stiffness_N_per_m, stiffness_N_per_m, 0.005 * stiffness_N_per_m) << i;
  }
}

/// As the second part of a long log: what the force does then is the law's, and no touch.
TEST(TouchFit, IsUnknownWhereTheSamplesBeginInContact) {
  test::Random random(5);
  for (int i = 0; i < 50; ++i) {
    FitRun run = touchRun({.stiffness_N_per_m = random.logUniform(50.0, 2e4)},
                          static_cast<std::uint64_t>(2000 + i));
    const double begins_s = run.felt_s + random.uniform(-0.04, 0.5);
    while (run.samples.front().t_s < begins_s) run.samples.pop_front();
    const double felt_s = std::max(run.felt_s, run.samples.front().t_s);
    EXPECT_FALSE(fitTouch(fitConfig(), 0, run.samples, felt_s).is_known) << begins_s;
  }
}

TEST(TouchFit, IsUnknownWhereNothingTells) {
  const ControllerConfig config = fitConfig();
  EXPECT_FALSE(fitTouch(config, 0, {}, 1.0).is_known);
  EXPECT_FALSE(fitOf({.position_m = 0.0005}, 1).is_known);  // at an end of the cover
  FitRun run = touchRun({}, 1);
  EXPECT_FALSE(fitTouch(config, 0, run.samples, 100.0).is_known);
  std::deque<TouchSample> torn = run.samples;
  torn.erase(torn.begin() + 1000, torn.begin() + 1100);
  EXPECT_FALSE(fitTouch(config, 0, torn, run.felt_s).is_known);
  std::deque<TouchSample> still = run.samples;
  for (TouchSample& sample : still) sample.q[0] = 0.0;
  EXPECT_FALSE(fitTouch(config, 0, still, run.felt_s).is_known);
  std::deque<TouchSample> wrong = run.samples;
  wrong[1100].q[0] = std::nan("");
  EXPECT_FALSE(fitTouch(config, 0, wrong, run.felt_s).is_known);
}

}  // namespace
}  // namespace tactus
