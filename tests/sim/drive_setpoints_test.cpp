#include "tactus/sim/drive_setpoints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/random.h"

namespace tactus {
namespace {

constexpr double kSetpointStep_s = 0.000125;

JointVector pairOf(double a, double b) { return Eigen::Vector2d(a, b); }

/// The way of a delayed setpoint is the way of the setpoint, so much earlier, also between steps.
TEST(DriveSetpoints, ComeLateByTheDeadTimeExactly) {
  test::Random random(931);
  for (const double dead_time_s : {0.0, 0.008, 0.0000625, 0.0123456, 0.1}) {
    DriveEffectsConfig config;
    config.dead_time_s = dead_time_s;
    DriveSetpoints drives(config, 2, kSetpointStep_s);
    std::vector<double> way{0.0};  // of the setpoint, at the end of each step
    double way_late = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double v = random.uniform(-1.0, 1.0);
      way.push_back(way.back() + kSetpointStep_s * v);
      way_late += kSetpointStep_s * drives.update(pairOf(v, -v))[0];
      const double steps = std::max(0.0, i + 1.0 - dead_time_s / kSetpointStep_s);
      const auto whole = static_cast<std::size_t>(std::floor(steps + 1e-9));
      const double rest = std::max(0.0, steps - static_cast<double>(whole));
      const double expected =
          way[whole] + (rest > 1e-9 ? rest * (way[whole + 1] - way[whole]) : 0.0);
      ASSERT_NEAR(way_late, expected, 1e-12) << dead_time_s << " " << i;
    }
  }
}

TEST(DriveSetpoints, ChangeNoFasterThanTheDriveAllows) {
  test::Random random(932);
  DriveEffectsConfig config;
  config.max_acceleration = pairOf(2.0, 30.0);
  DriveSetpoints drives(config, 2, kSetpointStep_s);
  JointVector before = pairOf(0.0, 0.0);
  JointVector target = before;
  for (int i = 0; i < 20000; ++i) {
    if (i % 500 == 0) target = random.vector(2, -0.5, 0.5);
    const JointVector now = drives.update(target);
    for (int k = 0; k < 2; ++k) {
      ASSERT_LE(std::abs(now[k] - before[k]),
                config.max_acceleration[k] * kSetpointStep_s * (1.0 + 1e-12));
      ASSERT_LE(std::abs(target[k] - now[k]), std::abs(target[k] - before[k])) << "nor beyond it";
    }
    before = now;
  }
  for (int i = 0; i < 8000; ++i) before = drives.update(target);
  EXPECT_LT((before - target).norm(), 1e-12) << "and comes there";
}

}  // namespace
}  // namespace tactus
