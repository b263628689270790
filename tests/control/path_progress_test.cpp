#include "tactus/control/path_progress.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tactus {
namespace {

constexpr double kWaitBeyond_m = 0.05;

TEST(PathProgress, FallsFromOneToZeroBetweenOnceAndTwiceTheLag) {
  for (const double share : {0.0, 0.3, 0.999, 1.0})
    EXPECT_EQ(pathProgress(share * kWaitBeyond_m, kWaitBeyond_m), 1.0) << share;
  for (const double share : {2.0, 2.001, 10.0, 1e300})
    EXPECT_EQ(pathProgress(share * kWaitBeyond_m, kWaitBeyond_m), 0.0) << share;
  EXPECT_NEAR(pathProgress(1.5 * kWaitBeyond_m, kWaitBeyond_m), 0.5, 1e-15);
  EXPECT_NEAR(pathProgress(1.25 * kWaitBeyond_m, kWaitBeyond_m), 27.0 / 32.0, 1e-15);
}

TEST(PathProgress, IsSmoothAndNeverRises) {
  constexpr double kStep = 1e-4;  // of wait_beyond_m
  double before = 1.0;
  double slope_before = 0.0;
  for (double share = 0.9; share < 2.1; share += kStep) {
    const double s = pathProgress(share * kWaitBeyond_m, kWaitBeyond_m);
    const double slope = (s - before) / kStep;
    ASSERT_LE(slope, 1e-12) << share;
    ASSERT_GE(slope, -1.5 - 1e-6) << share;
    ASSERT_NEAR(slope, slope_before, 6.1 * kStep) << share << ": a kink";
    before = s;
    slope_before = slope;
  }
  EXPECT_EQ(before, 0.0);
}

TEST(PathProgress, IsANumberForEveryLag) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kTiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(pathProgress(std::nan(""), kWaitBeyond_m), 1.0);
  EXPECT_EQ(pathProgress(kInfinity, kWaitBeyond_m), 0.0);
  EXPECT_EQ(pathProgress(1.0, kTiny), 0.0);
  EXPECT_EQ(pathProgress(0.0, kTiny), 1.0);
}

TEST(ToolLag, IsThatOfPositionAndOfOrientation) {
  TaskConfig task;
  task.components = {4, 2, 0, 3, 5, 1};
  task.size = 5;
  PaddedTaskVector error = PaddedTaskVector::Zero();
  error.head<5>() << 0.2, 0.03, -0.04, -0.1, 0.2;
  const ToolLag lag = toolLag(task, error);
  EXPECT_NEAR(lag.position_m, 0.05, 1e-15);
  EXPECT_NEAR(lag.rotation_rad, 0.3, 1e-15);
}

TEST(PathProgress, IsThatOfWhatLagsMore) {
  TaskGains gains;
  EXPECT_EQ(pathProgress(gains, {1e9, 1e9}), 1.0) << "it never waits";
  gains.wait_beyond_m = 0.01;
  EXPECT_EQ(pathProgress(gains, {0.015, 1e9}), 0.5);
  gains.wait_beyond_rad = 0.1;
  EXPECT_EQ(pathProgress(gains, {0.015, 0.0}), 0.5);
  EXPECT_NEAR(pathProgress(gains, {0.0125, 0.15}), 0.5, 1e-15);
  EXPECT_EQ(pathProgress(gains, {0.0, 0.2}), 0.0);
  EXPECT_TRUE(waitsForTurn(gains, {0.0125, 0.15}));
  EXPECT_FALSE(waitsForTurn(gains, {0.019, 0.15}));
  EXPECT_FALSE(waitsForTurn(gains, {0.019, 0.1}));
  gains.wait_beyond_m = kNoLimit;
  EXPECT_TRUE(waitsForTurn(gains, {1e9, 0.15}));
  EXPECT_NEAR(pathProgress(gains, {1e9, 0.15}), 0.5, 1e-15);
}

}  // namespace
}  // namespace tactus
