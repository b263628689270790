#include "tactus/supervisor/swing_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "support/random.h"

namespace tactus {
namespace {

constexpr double kSwingPeriod_s = 0.001;
constexpr double kLeast_N = 0.57;

/// Of a force over time, 5 s of it.
template <class Force>
double largestSwing(const Force& force) {
  SwingWatch watch;
  double largest = 0.0;
  for (int i = 0; i < 5000; ++i) {
    watch.update(force(kSwingPeriod_s * i), kLeast_N, kSwingPeriod_s);
    largest = std::max(largest, watch.swing_N());
  }
  return largest;
}

double sine(double t_s, double hz) { return std::sin(2.0 * std::numbers::pi * hz * t_s); }

TEST(SwingWatch, TellsHowFarAForceSwings) {
  for (const double hz : {1.0, 3.0, 10.0, 40.0}) {
    const double swing = largestSwing([&](double t_s) { return 4.0 + 0.5 * sine(t_s, hz); });
    EXPECT_NEAR(swing, 1.0, 0.02) << hz;
  }
}

TEST(SwingWatch, SaysNothingOfWhatIsSmallOrDiesAway) {
  EXPECT_EQ(largestSwing([](double t_s) { return 4.0 + 0.2 * sine(t_s, 5.0); }), 0.0);
  for (const double damping_per_s : {2.0, 4.0, 10.0}) {
    const auto force = [&](double t_s) {
      return 4.0 + 4.0 * std::exp(-damping_per_s * t_s) * sine(t_s, 3.0);
    };
    EXPECT_EQ(largestSwing(force), 0.0) << damping_per_s;
  }
  EXPECT_EQ(largestSwing([](double t_s) { return 10.0 * t_s; }), 0.0);
  test::Random random(1901);
  EXPECT_EQ(largestSwing([&](double) { return 4.0 + random.uniform(-0.1, 0.1); }), 0.0);
}

/// Well before it is as large as what it is to be kept from.
TEST(SwingWatch, FindsOneThatGrows) {
  for (const double hz : {2.0, 5.0, 15.0}) {
    SwingWatch watch;
    double amplitude = 0.1;
    double force = 4.0;
    for (int i = 0; i < 10000 && watch.swing_N() == 0.0; ++i) {
      amplitude = 0.1 * std::pow(1.3, hz * kSwingPeriod_s * i);
      force = 4.0 + amplitude * sine(kSwingPeriod_s * i, hz);
      watch.update(force, kLeast_N, kSwingPeriod_s);
    }
    EXPECT_GT(watch.swing_N(), 0.0) << hz;
    EXPECT_LT(amplitude, 1.0) << hz;
  }
}

/// To and fro between numbers that have no rounding.
double leastOfSteps(std::initializer_list<double> forces_N, double least_N, double step_s = 0.125) {
  SwingWatch watch;
  for (const double force_N : forces_N)
    for (int i = 0; i < std::lround(step_s / kSwingPeriod_s); ++i)
      watch.update(force_N, least_N, kSwingPeriod_s);
  return watch.swing_N();
}

/// A swing is over, and counts, once the force has come back from its end by half of what counts.
TEST(SwingWatch, JudgesTheLastThreeByTheLeastOfThem) {
  EXPECT_EQ(leastOfSteps({2, 3, 2, 3, 2, 3}, 1.0), 1.0) << "just as large as what counts";
  EXPECT_EQ(leastOfSteps({2, 3, 2, 3, 2, 3}, 1.01), 0.0);
  EXPECT_EQ(leastOfSteps({2, 3, 2, 3, 2, 2.5}, 1.0), 0.0) << "the third is not yet over";
  EXPECT_EQ(leastOfSteps({2, 3, 2, 3, 2, 2.5625}, 1.0), 1.0);
  EXPECT_EQ(leastOfSteps({0, 4, 0.75, 3.5, 1}, 1.0), 2.75) << "they shrink slowly";
  EXPECT_EQ(leastOfSteps({0, 5, 1, 5, 1}, 1.0), 4.0) << "to just eight tenths";
  EXPECT_EQ(leastOfSteps({0, 5, 0, 4, 0}, 1.0), 4.0) << "the newest to just as much";
  EXPECT_EQ(leastOfSteps({0, 4, 1, 4, 1}, 1.0), 0.0) << "to less";
  EXPECT_EQ(leastOfSteps({0, 4, 0, 3, 0}, 1.0), 0.0) << "so does the newest";
  EXPECT_EQ(leastOfSteps({0, 2, 1, 3.5, 1}, 1.0), 0.0) << "and the one between";
  EXPECT_EQ(leastOfSteps({0, 2, 0, 4, 0}, 1.0), 2.0) << "they may grow";
}

/// A force that only falls, or steps once, does not swing.
TEST(SwingWatch, WantsThreeSwings) {
  EXPECT_EQ(leastOfSteps({5, 0}, 1.0), 0.0);
  EXPECT_EQ(leastOfSteps({5, 0, 5}, 1.0), 0.0) << "a blow, to and fro";
  EXPECT_EQ(leastOfSteps({0, 5, 0}, 1.0), 0.0);
}

TEST(SwingWatch, ForgetsAfterASecondWithoutATurn) {
  EXPECT_EQ(leastOfSteps({2, 3, 2, 3, 2, 3}, 1.0, 0.95), 1.0);
  EXPECT_EQ(leastOfSteps({2, 3, 2, 3, 2, 3}, 1.0, 1.05), 0.0);
}

/// With a period whose sums have no rounding.
TEST(SwingWatch, RemembersForOneSecondToTheCycle) {
  constexpr double kTick = 1.0 / 1024.0;
  SwingWatch watch;
  for (const double force_N : {2.0, 3.0, 2.0, 3.0, 2.0, 3.0}) watch.update(force_N, 0.5, kTick);
  for (int i = 0; i < 1024; ++i) {
    watch.update(3.0, 0.5, kTick);
    ASSERT_EQ(watch.swing_N(), 1.0) << i;
  }
  watch.update(3.0, 0.5, kTick);
  EXPECT_EQ(watch.swing_N(), 0.0);
}

/// As a moving obstacle leaves it.
TEST(SwingWatch, ForgetsSlowOnes) {
  EXPECT_EQ(largestSwing([](double t_s) { return 4.0 + 2.0 * sine(t_s, 0.3); }), 0.0);
}

}  // namespace
}  // namespace tactus
