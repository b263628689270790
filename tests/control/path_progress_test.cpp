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

/// Its rotation may lag as it will.
TEST(ToolLag, IsThatOfThePosition) {
  TaskConfig task;
  task.components = {4, 2, 0, 3, 5, 1};
  task.size = 5;
  PaddedTaskVector error = PaddedTaskVector::Zero();
  error.head<5>() << 0.7, 0.03, -0.04, 0.8, 0.9;
  EXPECT_NEAR(toolLag_m(task, error), 0.05, 1e-15);
}

}  // namespace
}  // namespace tactus
