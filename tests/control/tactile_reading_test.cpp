#include "tactus/control/tactile_reading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "support/period.h"
#include "support/random.h"
#include "support/tactile_samples.h"
#include "tactus/math/filter.h"

/// What a reading remembers of the pushes before its newest sample.
namespace tactus {
namespace {

constexpr double kAt_m = 0.2;
constexpr int kSampleCycles = 4;

TactileModuleConfig moduleThatFilters(double cutoff_hz) {
  TactileModuleConfig module;
  module.length_m = 0.38;
  module.max_force_N = 1e3;
  module.filter_cutoff_hz = cutoff_hz;
  return module;
}

struct Remembered {
  double other_side_N = 0.0;  ///< the largest that samples say of it, of 1 N from this side
  double other_way_N = 0.0;   ///< of what is remembered
};

/// A blow of so long from the side of +y, behind the module's filter.
Remembered blow(double cutoff_hz, double duration_s) {
  const TactileModuleConfig module = moduleThatFilters(cutoff_hz);
  ButterworthLowPass filter(cutoff_hz, 1.0 / test::kPeriod_s);
  TactileReading reading;
  Remembered worst;
  double peak_N = 0.0;
  for (int cycle = 0; cycle * test::kPeriod_s < duration_s + 12.0 / cutoff_hz; ++cycle) {
    const double phase = cycle * test::kPeriod_s / duration_s;
    const double force_N = phase < 1.0 ? 90.0 * std::sin(std::numbers::pi * phase) : 0.0;
    const double felt_N = filter.update(force_N + 1e-3);
    const auto sequence = static_cast<std::uint32_t>(cycle / kSampleCycles + 1);
    readSample(module, test::touchAt(kAt_m, felt_N, 0.0, sequence), test::kPeriod_s, reading);
    peak_N = std::max(peak_N, felt_N);
    worst.other_side_N = std::max(worst.other_side_N, -felt_N / peak_N);
    if (reading.hardest.direction.y() < 0.0)
      worst.other_way_N = std::max(worst.other_way_N, reading.hardest.force_N / peak_N);
  }
  return worst;
}

TEST(HardestPush, IsOfTheSideThatStruckWhateverTheFilterSaysAfterIt) {
  double other_side_N = 0.0, other_way_N = 0.0;
  for (const double cutoff_hz : {3.0, 15.0, 60.0}) {
    for (double duration_s = 0.005; duration_s < 0.5; duration_s *= 1.2) {
      const Remembered worst = blow(cutoff_hz, duration_s);
      other_side_N = std::max(other_side_N, worst.other_side_N);
      other_way_N = std::max(other_way_N, worst.other_way_N);
    }
  }
  std::printf("from the other side %.3f of a blow, remembered %.3f\n", other_side_N, other_way_N);
  EXPECT_LE(other_side_N, 1.0 / 8.0);
  EXPECT_GE(other_side_N, 0.1) << "no blow does that: this test is blind";
  EXPECT_LE(other_way_N, 0.01);
}

/// Else each operation on what is left of it would cost a hundred times as much, for ever.
TEST(HardestPush, FadesToZeroAndNotToSubnormalNumbers) {
  const TactileModuleConfig module = moduleThatFilters(15.0);
  TactileReading reading;
  for (std::uint32_t i = 1; i < 100000; ++i) {
    const double force_N = i == 1 ? 10.0 : 0.0;
    readSample(module, test::touchAt(kAt_m, force_N, 0.0, i), test::kPeriod_s, reading);
    ASSERT_NE(std::fpclassify(reading.hardest.force_N), FP_SUBNORMAL) << i;
  }
  EXPECT_EQ(reading.hardest.force_N, 0.0);
}

TEST(HardestPush, IsAtLeastTheNewestAndFades) {
  test::Random random(940);
  const TactileModuleConfig module = moduleThatFilters(15.0);
  TactileReading reading;
  double before_N = 0.0;
  std::uint32_t sequence = 0;
  for (int i = 0; i < 2000; ++i) {
    const double force_N = random.uniform(0.0, 50.0);
    const double angle = random.uniform(-3.0, 3.0);
    const int cycles = random.integer(1, 20);
    ++sequence;
    for (int k = 0; k < cycles; ++k)
      readSample(module, test::touchAt(kAt_m, force_N, angle, sequence), test::kPeriod_s, reading);
    ASSERT_GE(reading.hardest.force_N, force_N * (1.0 - 1e-12));
    ASSERT_LE(reading.hardest.force_N, std::max(force_N, before_N) * (1.0 + 1e-12));
    before_N = reading.hardest.force_N;
  }
  for (int i = 0; i < 100; ++i)  // a sample each 4 cycles of no push
    for (int k = 0; k < kSampleCycles; ++k)
      readSample(module, test::touchAt(kAt_m, 0.0, 0.0, sequence + i + 1), test::kPeriod_s,
                 reading);
  EXPECT_LE(reading.hardest.force_N, before_N * std::exp(-0.4 / kPushFades_s) * 1.01);
}

/// Of two that are as hard, the newer says where the push is.
TEST(HardestPush, IsTheNewerOfTwoThatAreAsHard) {
  const TactileModuleConfig module = moduleThatFilters(1e6);
  TactileReading reading;
  readSample(module, test::touchAt(kAt_m, 4.0, 0.0, 1), test::kPeriod_s, reading);
  ASSERT_EQ(reading.hardest.force_N, 4.0);
  readSample(module, test::touchAt(0.1, 2.0, 0.0, 2), 0.5 * kPushFades_s, reading);
  EXPECT_EQ(reading.hardest.force_N, 2.0) << "half of 4 N, and the newest";
  EXPECT_EQ(reading.hardest.position_m, 0.1);
}

/// A reading that no arm or obstacle bears is none of a push.
TEST(Excess, IsOfAReadingThatMayBeOne) {
  const TactileModuleConfig module = moduleThatFilters(15.0);
  TactileReading reading;
  std::uint32_t sequence = 0;
  const auto hasExcess = [&](double force_N) {
    readSample(module, test::touchAt(kAt_m, force_N, 0.5, ++sequence), test::kPeriod_s, reading);
    return reading.has_excess;
  };
  EXPECT_FALSE(hasExcess(999.0)) << "within the range";
  EXPECT_TRUE(hasExcess(1001.0));
  EXPECT_NEAR(reading.excess.force_N, 1001.0, 1e-9);
  EXPECT_NEAR(reading.detail.value, 1001.0, 1e-9);
  EXPECT_TRUE(hasExcess(0.999e6));
  EXPECT_FALSE(hasExcess(1.001e6));
  readSample(module, {1e6, 0.0, 0.0, 0.0, ++sequence}, test::kPeriod_s, reading);
  EXPECT_FALSE(reading.has_excess) << "exactly";
  EXPECT_EQ(reading.fault, Fault::kTactileInvalid);
  EXPECT_FALSE(hasExcess(std::nan("")));
  EXPECT_FALSE(hasExcess(5.0));
  EXPECT_EQ(reading.fault, Fault::kNone);
  EXPECT_EQ(reading.contact.interval_s, test::kPeriod_s);
}

TEST(HardestPush, AnInvalidSampleLeavesItButForWhatFades) {
  const TactileModuleConfig module = moduleThatFilters(15.0);
  TactileReading reading;
  readSample(module, test::touchAt(kAt_m, 9.0, 0.5, 1), test::kPeriod_s, reading);
  readSample(module, test::touchAt(0.1, 1e4, -2.0, 2), test::kPeriod_s, reading);
  EXPECT_NEAR(reading.hardest.force_N, 9.0 * (1.0 - test::kPeriod_s / kPushFades_s), 1e-9);
  EXPECT_NEAR(reading.hardest.position_m, kAt_m, 1e-9);
  for (int i = 3; i < 2000; ++i)
    readSample(module, test::touchAt(0.1, 1e4, -2.0, i), test::kPeriod_s, reading);
  EXPECT_LT(reading.hardest.force_N, 1e-6) << "two seconds later nothing of it is left";
}

TEST(SampleAge, IsThatAPeriodAfterTheLastCycle) {
  TactileReading reading;
  const TactileModuleConfig module = moduleThatFilters(15.0);
  readSample(module, {1.0, 0.0, 0.0, 0.0, 7}, 0.001, reading);
  EXPECT_EQ(sampleAge_s({1.0, 0.0, 0.0, 0.0, 7}, 0.001, reading), 0.001);
  readSample(module, {1.0, 0.0, 0.0, 0.0, 7}, 0.25, reading);
  EXPECT_EQ(sampleAge_s({1.0, 0.0, 0.0, 0.0, 7}, 0.5, reading), 0.75);
  EXPECT_EQ(sampleAge_s({1.0, 0.0, 0.0, 0.0, 8}, 0.5, reading), 0.0) << "a new one has come";
}

}  // namespace
}  // namespace tactus
