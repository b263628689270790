#include "tactus/analysis/stability_margins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "support/random.h"
#include "tactus/control/controller_config.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

using test::Random;

constexpr double kDegree = std::numbers::pi / 180.0;

/// The paper's gains, sensor and drives.
ContactLoop paperLoop(LoopLaw law = LoopLaw::kOneSpace) {
  ContactLoop loop;
  loop.law = law;
  return loop;
}

double largestRatio(const ContactLoop& loop) {
  return computeMargins(loop, 1.0).largest_stiffness_ratio;
}

// The table of docs/approach_speed_limit.md.
TEST(LargestStiffnessRatio, OfTheApproachLimitIsThatOfItsDerivation) {
  ContactLoop paper = paperLoop(LoopLaw::kApproachLimit);
  paper.order = 1;
  EXPECT_NEAR(largestRatio(paper), 7.42, 0.005);
  for (const auto& [sample_s, ratio] : {std::pair{0.008, 7.055}, {0.02, 6.29}}) {
    ContactLoop loop = paper;
    loop.sample_period_s = sample_s;
    EXPECT_NEAR(largestRatio(loop), ratio, 0.005);
  }
  for (const auto& [lag_s, ratio] : {std::pair{0.0, 8.205}, {0.01, 7.145}}) {
    ContactLoop loop = paper;
    loop.drive_lag_s = loop.model_drive_lag_s = lag_s;
    EXPECT_NEAR(largestRatio(loop), ratio, 0.005);
  }
  for (const auto& [T_s, ratio] : {std::pair{0.05, 4.614}, {0.2, 13.10}}) {
    ContactLoop loop = paper;
    loop.time_constant_s = T_s;
    EXPECT_NEAR(largestRatio(loop), ratio, 0.005);
  }
}

/// For c_e = c nothing of the delay is left, and a softer contact is stable with every delay.
TEST(LargestStiffnessRatio, OfTheApproachLimitIsAboveOneWithEveryDelay) {
  test::Random random(91);
  for (int trial = 0; trial < 100; ++trial) {
    ContactLoop loop = paperLoop(LoopLaw::kApproachLimit);
    loop.order = 1;
    loop.time_constant_s = random.uniform(0.02, 0.5);
    loop.drive_lag_s = loop.model_drive_lag_s = random.uniform(0.0, 0.2);
    loop.filter_cutoff_hz = loop.model_filter_cutoff_hz = random.uniform(2.0, 60.0);
    loop.sample_period_s = 0.001 * std::floor(random.uniform(1.0, 20.0));
    for (const double ratio : {0.01, 0.1, 0.5, 1.0}) EXPECT_TRUE(isStable(loop, ratio)) << ratio;
  }
}

TEST(LargestStiffnessRatio, AgreesWithAnIndependentImplementation) {
  ContactLoop loop = paperLoop();
  EXPECT_NEAR(largestRatio(loop), 4.83, 0.005);
  loop.drive_lag_s = 0.0;
  EXPECT_NEAR(largestRatio(loop), 5.68, 0.005);
  loop.drive_lag_s = 0.01;
  EXPECT_NEAR(largestRatio(loop), 4.24, 0.005);
  EXPECT_NEAR(largestRatio(paperLoop(LoopLaw::kTwoSpaces)), 2.42, 0.005);
  loop = paperLoop();
  loop.time_constant_s = 0.05;
  EXPECT_NEAR(largestRatio(loop), 1.75, 0.005);
  loop.time_constant_s = 0.2;
  EXPECT_NEAR(largestRatio(loop), 10.6, 0.05);
  loop = paperLoop();
  loop.damping = 1.0;
  EXPECT_NEAR(largestRatio(loop), 2.66, 0.005);
}

/// The open loop at the force sample by its transfer functions, with what the sampler folds down.
class FrequencyResponse {
 public:
  explicit FrequencyResponse(const ContactLoop& loop)
      : loop_(loop), filter_(loop.filter_cutoff_hz, loop.filter_rate_hz) {}

  std::complex<double> at(double omega) const {
    const int cycles = static_cast<int>(std::lround(loop_.sample_period_s / loop_.period_s));
    std::complex<double> sum = 0.0;
    for (int fold = 0; fold < cycles; ++fold)
      sum += ofCycles(
          std::polar(1.0, omega * loop_.period_s + 2.0 * std::numbers::pi * fold / cycles), cycles);
    return sum / static_cast<double>(cycles);
  }

  double phaseMargin() const {
    double low = 0.1, high = 200.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (std::abs(at(middle)) > 1.0 ? low : high) = middle;
    }
    return std::numbers::pi + std::arg(at(low));
  }

 private:
  /// Hold, law, drives, spring with c_e = c, filter and the cycle until a sample is used.
  std::complex<double> ofCycles(std::complex<double> z, int cycles) const {
    const double dt = loop_.period_s, T = loop_.time_constant_s;
    const double integral = loop_.order == 2 ? dt / (T * T) : 0.0;
    const double share = lagShare(dt, loop_.drive_lag_s);
    std::complex<double> hold = 0.0, numerator = 0.0, denominator = 0.0;
    for (int i = 0; i < cycles; ++i) hold += std::pow(z, -i);
    for (int i = 0; i < 4; ++i) {
      numerator += filter_.numerator()[i] * std::pow(z, -i);
      denominator += filter_.denominator()[i] * std::pow(z, -i);
    }
    const double P = (loop_.order == 2 ? 2.0 * loop_.damping : 1.0) / T;
    return hold * (P + integral / (z - 1.0)) * dt / (1.0 - 1.0 / z) * share /
           (1.0 - (1.0 - share) / z) * numerator / denominator / z;
  }

  ContactLoop loop_;
  ButterworthLowPass filter_;
};

TEST(PhaseMargin, IsThatOfTheOpenLoopsFrequencyResponse) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    ContactLoop loop;
    loop.order = random.integer(1, 2);
    loop.time_constant_s = random.logUniform(0.1, 1.0);
    loop.damping = random.uniform(0.5, 1.0);
    loop.drive_lag_s = random.uniform(0.0, 0.01);
    loop.filter_cutoff_hz = random.uniform(10.0, 60.0);
    const double expected = FrequencyResponse(loop).phaseMargin();
    ASSERT_NEAR(computeMargins(loop, 1.0).phase_margin_rad, expected, 1e-6) << i;
  }
}

/// A continuous loop with the hold as a delay of 2.5 ms has 30.8 degrees.
TEST(PhaseMargin, OfThePapersGains) {
  EXPECT_NEAR(computeMargins(paperLoop(), 1.0).phase_margin_rad / kDegree, 31.41, 0.01);
  EXPECT_NEAR(computeMargins(paperLoop(LoopLaw::kTwoSpaces), 1.0).phase_margin_rad / kDegree, 30.41,
              0.01);
}

TEST(PhaseMargin, VanishesAtTheLargestStiffnessRatio) {
  const ContactLoop loop = paperLoop();
  const double largest = largestRatio(loop);
  EXPECT_EQ(computeMargins(loop, 1.001 * largest).phase_margin_rad, 0.0);
  const StabilityMargins near_the_end = computeMargins(loop, 0.999 * largest);
  EXPECT_GT(near_the_end.phase_margin_rad, 0.0);
  EXPECT_LT(near_the_end.phase_margin_rad, 0.1 * kDegree);
  EXPECT_NEAR(near_the_end.gain_margin, 1.0 / 0.999, 1e-6);
}

/// Whatever the rates, not only those of the paper.
ContactLoop randomLoop(Random& random) {
  ContactLoop loop;
  loop.law = random.chance(0.5) ? LoopLaw::kOneSpace : LoopLaw::kTwoSpaces;
  loop.order = random.integer(1, 2);
  loop.time_constant_s = random.logUniform(0.03, 1.0);
  loop.damping = random.logUniform(0.3, 2.0);
  constexpr double kPeriods[] = {0.00025, 0.0005, 0.001, 0.002, 0.003};
  loop.period_s = kPeriods[random.index(5)];
  loop.drive_lag_s = random.chance(0.2) ? 0.0 : random.logUniform(1e-3, 0.03);
  loop.filter_cutoff_hz = random.logUniform(8.0, 100.0);
  loop.sample_period_s = 0.001 * random.integer(1, 8);
  return loop;
}

TEST(LargestStiffnessRatio, SeparatesStableFromUnstable) {
  Random random(2);
  for (int i = 0; i < 40; ++i) {
    const ContactLoop loop = randomLoop(random);
    const double largest = largestRatio(loop);
    if (largest == 0.0) continue;
    for (const double share : {0.05, 0.2, 0.5, 0.9, 0.9999})
      ASSERT_TRUE(isStable(loop, share * largest)) << i << " " << share;
    for (const double share : {1.0001, 1.1, 3.0, 30.0, 1000.0})
      ASSERT_FALSE(isStable(loop, share * largest)) << i << " " << share;
  }
}

TEST(LargestStiffnessRatio, FallsWithEveryDelay) {
  Random random(3);
  for (int i = 0; i < 30; ++i) {
    const ContactLoop loop = randomLoop(random);
    const double largest = largestRatio(loop);
    ContactLoop slower = loop;
    slower.drive_lag_s += 0.003;
    ASSERT_LE(largestRatio(slower), largest) << i;
    slower = loop;
    slower.sample_period_s += 0.004;
    ASSERT_LE(largestRatio(slower), largest) << i;
    slower = loop;
    slower.filter_cutoff_hz *= 0.8;
    ASSERT_LE(largestRatio(slower), largest) << i;
  }
}

TEST(LargestStiffnessRatio, OfTwoSpacesIsHalfThatOfOne) {
  Random random(4);
  for (int i = 0; i < 30; ++i) {
    ContactLoop loop = randomLoop(random);
    loop.law = LoopLaw::kOneSpace;
    const double one = largestRatio(loop);
    loop.law = LoopLaw::kTwoSpaces;
    ASSERT_NEAR(largestRatio(loop), 0.5 * one, 1e-6 * one) << i;
  }
}

/// With all times k times as long the loop is the same, k times as slow.
TEST(LargestStiffnessRatio, DependsOnRatiosOfTimesOnly) {
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const ContactLoop loop = randomLoop(random);
    ContactLoop slow = loop;
    for (double* time_s :
         {&slow.time_constant_s, &slow.period_s, &slow.drive_lag_s, &slow.sample_period_s})
      *time_s *= 2.0;
    slow.filter_cutoff_hz /= 2.0;
    slow.filter_rate_hz /= 2.0;
    const double largest = largestRatio(loop);
    ASSERT_NEAR(largestRatio(slow), largest, 1e-6 * largest) << i;
  }
}

/// Only P = 2 d / (T c) and 1 / (T^2 c) enter.
TEST(LargestStiffnessRatio, GrowsWithTheSquareOfTAtTheSameDT) {
  Random random(7);
  for (int i = 0; i < 20; ++i) {
    ContactLoop loop = randomLoop(random);
    loop.order = 2;
    ContactLoop slow = loop;
    slow.time_constant_s *= 3.0;
    slow.damping /= 3.0;
    const double largest = largestRatio(loop);
    if (largest < 0.01) continue;
    ASSERT_NEAR(largestRatio(slow), 9.0 * largest, 1e-5 * largest) << i;
  }
}

TEST(DriftGain, HardlyEverCostsStability) {
  Random random(6);
  for (int i = 0; i < 40; ++i) {
    const ContactLoop loop = randomLoop(random);
    ContactLoop pulled = loop;
    pulled.drift_gain_per_s = random.logUniform(0.1, 0.5 / loop.period_s);
    ASSERT_GE(largestRatio(pulled), 0.999 * largestRatio(loop)) << i;
  }
}

TEST(LargestStiffnessRatio, IsZeroWhereTheTimeConstantIsShorterThanTheDelays) {
  ContactLoop loop = paperLoop();
  loop.time_constant_s = 0.02;  // 2 d T is below the 30 ms of filter, hold and drives
  EXPECT_EQ(largestRatio(loop), 0.0);
  EXPECT_EQ(computeMargins(loop, 1.0).phase_margin_rad, 0.0);
}

TEST(SmallestTimeConstant, SeparatesStableFromUnstable) {
  ContactLoop loop = paperLoop(LoopLaw::kTwoSpaces);
  loop.time_constant_s = 0.02;
  const double T_s = smallestTimeConstant(loop, 1.0, 0.0);
  loop.time_constant_s = 1.0001 * T_s;
  EXPECT_GT(largestRatio(loop), 1.0);
  loop.time_constant_s = 0.9999 * T_s;
  EXPECT_LT(largestRatio(loop), 1.0);
  loop.damping = 1e-4;  // 2 d T stays below the delays
  EXPECT_EQ(smallestTimeConstant(loop, 1.0, 0.0), kNoLimit);
}

/// The margin asked for is the one that is measured where the limit was found.
TEST(PhaseMarginAskedFor, IsHadAtTheLimits) {
  constexpr double kAsked_rad = std::numbers::pi / 6.0;
  for (const LoopLaw law : {LoopLaw::kOneSpace, LoopLaw::kTwoSpaces}) {
    ContactLoop loop = paperLoop(law);
    const double ratio = largestStiffnessRatio(loop, kAsked_rad);
    EXPECT_NEAR(computeMargins(loop, ratio).phase_margin_rad, kAsked_rad, 1e-6);
    loop.time_constant_s = 0.02;
    loop.time_constant_s = smallestTimeConstant(loop, 3.0, kAsked_rad);
    EXPECT_NEAR(computeMargins(loop, 3.0).phase_margin_rad, kAsked_rad, 1e-6);
  }
}

TEST(PhaseMarginAskedFor, IsNotToBeHadEverywhere) {
  constexpr double kAsked_rad = std::numbers::pi / 6.0;
  ContactLoop late = paperLoop(LoopLaw::kTwoSpaces);
  late.drive_lag_s = 0.01;
  late.sample_period_s = 0.005;
  EXPECT_GT(largestStiffnessRatio(late, 0.0), 1.0);
  EXPECT_EQ(largestStiffnessRatio(late, kAsked_rad), 0.0);
  ContactLoop ringing = paperLoop();
  ringing.damping = 0.1;  // 11 degrees as stiff as assumed, without any delay
  EXPECT_LT(smallestTimeConstant(ringing, 1.0, 0.0), kNoLimit);
  EXPECT_EQ(smallestTimeConstant(ringing, 1.0, kAsked_rad), kNoLimit);
}

TEST(Stability, IsNotFoundWhereNumbersOverflow) {
  EXPECT_FALSE(isStable(paperLoop(), 1e300));
  EXPECT_FALSE(isStable(paperLoop(), kNoLimit));
}

TEST(CommonPeriod, HoldsWholeCyclesAndSamples) {
  ContactLoop loop;
  EXPECT_EQ(stepsOfCommonPeriod(loop), 4);
  loop.period_s = 0.00025;
  EXPECT_EQ(stepsOfCommonPeriod(loop), 16);
  loop.period_s = 0.003;
  EXPECT_EQ(stepsOfCommonPeriod(loop), 12);
  loop.period_s = 0.008;
  EXPECT_EQ(stepsOfCommonPeriod(loop), 8);
  loop.sample_period_s = 9.973;
  EXPECT_EQ(stepsOfCommonPeriod(loop), 0) << "too long to be lifted";
}

TEST(FilterInTheDaemon, DelaysMuchLikeTheModulesOwn) {
  ContactLoop loop = paperLoop();
  loop.filters_at_samples = true;
  const double at_samples = largestRatio(loop);
  EXPECT_NEAR(at_samples, largestRatio(paperLoop()), 0.5);
  EXPECT_NE(at_samples, largestRatio(paperLoop()));
}

}  // namespace
}  // namespace tactus
