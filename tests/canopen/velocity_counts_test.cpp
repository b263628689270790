#include "tactus/canopen/velocity_counts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/random.h"

namespace tactus {
namespace {

TEST(VelocityCounts, LosesNothingOverTime) {
  test::Random random(404);
  for (int run = 0; run < 200; ++run) {
    const double scale = random.sign() * random.logUniform(1.0, 1e7);
    VelocityCounts counts(scale);
    long double asked = 0.0;
    long double sent = 0.0;
    for (int cycle = 0; cycle < 2000; ++cycle) {
      const double velocity = random.sign() * random.logUniform(1e-9, 100.0);
      const double before = velocity * scale;
      const std::int32_t count = counts.next(velocity);
      ASSERT_LE(std::abs(count - before), 1.0) << "more than its rounding and the carried one";
      asked += static_cast<long double>(velocity) * scale;
      sent += count;
      ASSERT_LE(std::abs(static_cast<double>(sent - asked)), 0.5 + 1e-5) << cycle;
    }
  }
}

TEST(VelocityCounts, SendsSlowVelocitiesOnTheAverage) {
  VelocityCounts counts(1e5);
  long sum = 0;
  for (int cycle = 0; cycle < 10000; ++cycle) sum += counts.next(1e-6);  // 0.1 counts/s
  EXPECT_NEAR(static_cast<double>(sum), 1000.0, 1.0);
}

TEST(VelocityCounts, StandsStillAtZeroWhateverIsCarried) {
  for (double left : {0.5, -0.5, 1.5, -1.5, 0.49, 2.5}) {
    VelocityCounts counts(1.0);
    counts.next(left);
    for (int cycle = 0; cycle < 10; ++cycle) EXPECT_EQ(counts.next(0.0), 0) << left;
  }
}

TEST(VelocityCounts, Saturates) {
  constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();
  VelocityCounts counts(-1e6);
  EXPECT_EQ(counts.next(3000.0), -kMax);
  EXPECT_EQ(counts.next(-3000.0), kMax);
  EXPECT_EQ(counts.next(std::numeric_limits<double>::max()), -kMax);
  EXPECT_EQ(counts.next(-std::numeric_limits<double>::infinity()), kMax);
  EXPECT_EQ(counts.next(0.0), 0) << "nothing of it is carried";
  EXPECT_EQ(counts.next(-2147.483646), kMax - 1);
  VelocityCounts other(1.0);
  EXPECT_EQ(other.next(0.4), 0);
  EXPECT_EQ(other.next(1e12), kMax);
  EXPECT_EQ(other.next(0.3), 0) << "nor of what was before";
}

TEST(VelocityCounts, ForgetsTheRestOnReset) {
  VelocityCounts counts(1.0);
  counts.next(0.4);
  counts.reset();
  EXPECT_EQ(counts.next(0.4), 0);
  EXPECT_EQ(counts.next(0.4), 1);
}

}  // namespace
}  // namespace tactus
