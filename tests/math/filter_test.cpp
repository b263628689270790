#include "tactus/math/filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "support/random.h"

namespace tactus {
namespace {

// scipy 1.10.1: b, a = scipy.signal.butter(3, 15, fs=1000)
constexpr double kB[4] = {9.544250842372811e-05, 0.00028632752527118436, 0.00028632752527118436,
                          9.544250842372811e-05};
constexpr double kA[4] = {1.0, -2.811573677324689, 2.6404834927783396, -0.8281462753862606};

/// Amplitude of the answer to a sine of amplitude 1, once transients have gone.
double amplitude(double frequency_hz, double cutoff_hz, double rate_hz) {
  ButterworthLowPass filter(cutoff_hz, rate_hz);
  const int settle = static_cast<int>(20.0 * rate_hz / cutoff_hz);
  const int whole_periods = static_cast<int>(50.0 * rate_hz / frequency_hz);
  double sine_part = 0.0;
  double cosine_part = 0.0;
  for (int i = 0; i < settle + whole_periods; ++i) {
    const double phase = 2.0 * std::numbers::pi * frequency_hz * i / rate_hz;
    const double output = filter.update(std::sin(phase));
    if (i < settle) continue;
    sine_part += output * std::sin(phase);
    cosine_part += output * std::cos(phase);
  }
  return 2.0 * std::hypot(sine_part, cosine_part) / whole_periods;
}

TEST(ButterworthLowPass, FollowsTheDifferenceEquationOfScipy) {
  ButterworthLowPass filter(15.0, 1000.0);
  test::Random random(91);
  std::vector<double> x(4, 0.0);
  std::vector<double> y(4, 0.0);
  for (int i = 0; i < 2000; ++i) {
    x.push_back(random.uniform(-10.0, 10.0));
    double expected = kB[0] * x.back();
    for (int k = 1; k < 4; ++k) expected += kB[k] * x[x.size() - 1 - k] - kA[k] * y[y.size() - k];
    y.push_back(expected);
    ASSERT_NEAR(filter.update(x.back()), expected, 1e-10) << i;
  }
}

TEST(Flushed, KeepsWhatIsAnything) {
  for (const double x : {0.0, 1.0, -1.0, 1e-99, -1e-99, 1e300}) EXPECT_EQ(flushed(x), x);
  for (const double x : {1e-101, -1e-101, 5e-324}) EXPECT_EQ(flushed(x), 0.0);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(flushed(-infinity), -infinity);
  EXPECT_TRUE(std::isnan(flushed(std::nan("")))) << "the gate has to see it";
}

TEST(ButterworthLowPass, EndsAtZeroWhenNothingIsLeft) {
  for (const double cutoff_hz : {1.0, 15.0, 200.0}) {
    ButterworthLowPass filter(cutoff_hz, 1000.0);
    for (int i = 0; i < 1000; ++i) filter.update(20.0);
    const int forgotten = static_cast<int>(400.0 * 1000.0 / cutoff_hz);
    double output = 1.0;
    for (int i = 0; i < forgotten; ++i) {
      output = filter.update(0.0);
      ASSERT_NE(std::fpclassify(output), FP_SUBNORMAL) << cutoff_hz << " Hz, step " << i;
    }
    EXPECT_EQ(output, 0.0) << cutoff_hz;
  }
}

TEST(ButterworthLowPass, AnswersAStepLikeScipy) {
  // scipy.signal.lfilter(b, a, numpy.ones(60)) at samples 0, 1, 5, 10, 20, 40, 59
  ButterworthLowPass filter(15.0, 1000.0);
  std::vector<double> y;
  for (int i = 0; i < 60; ++i) y.push_back(filter.update(1.0));
  EXPECT_NEAR(y[0], 9.544250842372811e-05, 1e-15);
  EXPECT_NEAR(y[1], 0.0006501136780769063, 1e-14);
  EXPECT_NEAR(y[5], 0.018235577557825153, 1e-13);
  EXPECT_NEAR(y[10], 0.0964999630217944, 1e-12);
  EXPECT_NEAR(y[20], 0.41818874560566943, 1e-12);
  EXPECT_NEAR(y[40], 1.0063494258724803, 1e-12);
  EXPECT_NEAR(y[59], 1.0656573997857242, 1e-11);
}

TEST(ButterworthLowPass, PassesDirectCurrentUnchangedAndEndsAtRest) {
  ButterworthLowPass filter(15.0, 1000.0);
  double output = 0.0;
  for (int i = 0; i < 2000; ++i) output = filter.update(7.5);
  EXPECT_NEAR(output, 7.5, 1e-10);
  for (int i = 0; i < 4000; ++i) output = filter.update(0.0);
  EXPECT_NEAR(output, 0.0, 1e-12);
}

TEST(ButterworthLowPass, HalvesThePowerAtTheCutOffAtAnyRate) {
  for (const double rate_hz : {100.0, 250.0, 1000.0, 4000.0})
    EXPECT_NEAR(amplitude(15.0, 15.0, rate_hz), std::sqrt(0.5), 1e-3) << rate_hz;
  EXPECT_NEAR(amplitude(30.0, 15.0, 1000.0), 0.12322161, 1e-4);   // scipy.signal.freqz
  EXPECT_NEAR(amplitude(100.0, 15.0, 1000.0), 0.00305744, 1e-5);  // scipy.signal.freqz
  EXPECT_NEAR(amplitude(1.0, 15.0, 1000.0), 0.99999996, 1e-4);
}

TEST(ButterworthLowPass, RefusesImpossibleCutOffs) {
  for (const double cutoff_hz : {0.0, -1.0, 500.0, 501.0, std::nan("")})
    EXPECT_THROW(ButterworthLowPass(cutoff_hz, 1000.0), std::invalid_argument) << cutoff_hz;
  EXPECT_THROW(ButterworthLowPass(15.0, 0.0), std::invalid_argument);
  EXPECT_NO_THROW(ButterworthLowPass(499.0, 1000.0));
}

TEST(LagShare, IsTheExactShareOfAFirstOrderLag) {
  EXPECT_DOUBLE_EQ(lagShare(0.005, 0.005), 1.0 - std::exp(-1.0));
  EXPECT_EQ(lagShare(0.001, 0.0), 1.0);
  EXPECT_EQ(lagShare(0.0, 0.5), 0.0);
  EXPECT_NEAR(lagShare(1e-12, 1.0), 1e-12, 1e-24) << "cancellation";
}

TEST(LagShare, TwoHalfStepsAreOneWholeStep) {
  test::Random random(92);
  for (int i = 0; i < 1000; ++i) {
    const double T = random.logUniform(1e-6, 1e3);
    const double dt = random.logUniform(1e-6, 10.0);
    const double half = lagShare(0.5 * dt, T);
    ASSERT_NEAR(half + (1.0 - half) * half, lagShare(dt, T), 1e-14);
    ASSERT_GE(half, 0.0);
    ASSERT_LE(half, 1.0);
  }
}

}  // namespace
}  // namespace tactus
