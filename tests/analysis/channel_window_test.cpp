#include "tactus/analysis/channel_window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/random.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// Near enough to a normal one: the sum of twelve.
double channelNoise(test::Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.uniform(0.0, 1.0);
  return sum;
}

struct DrawnChannels {
  ChannelVector mean = ChannelVector::Zero(), sigma = ChannelVector::Constant(30.0);
  ChannelVector drift_per_s = ChannelVector::Zero();
  double top = 1e9;   ///< of channel 2, where it is clipped
  double step = 1.0;  ///< counts
  bool is_filtered = false;
};

ChannelWindow drawnWindow(test::Random& random, const DrawnChannels& drawn, int samples = 250) {
  std::vector<ButterworthLowPass> filters(8, ButterworthLowPass(15.0, 250.0));
  ChannelWindow window;
  for (int k = 0; k < samples; ++k) {
    const double t_s = 3.0 + 0.004 * k;
    ChannelVector counts;
    for (int i = 0; i < 8; ++i) {
      double noise = drawn.sigma[i] * channelNoise(random);
      if (drawn.is_filtered) noise = 3.0 * filters[static_cast<std::size_t>(i)].update(noise);
      const double exact = drawn.mean[i] + drawn.drift_per_s[i] * (t_s - 3.5) + noise;
      counts[i] = drawn.step * std::round(exact / drawn.step);
    }
    counts[2] = std::min(counts[2], drawn.top);
    window.add(counts, t_s);
  }
  return window;
}

TEST(ChannelWindow, FindsMeanNoiseAndDrift) {
  test::Random random(11);
  for (int i = 0; i < 200; ++i) {
    DrawnChannels drawn;
    drawn.mean = random.vector<ChannelVector>(8, -8e6, 8e6);
    drawn.sigma = random.vector<ChannelVector>(8, 5.0, 500.0);
    drawn.drift_per_s = random.vector<ChannelVector>(8, -1e4, 1e4);
    const ChannelFigures figures = drawnWindow(random, drawn).figures();
    EXPECT_EQ(figures.samples, 250);
    EXPECT_NEAR(figures.duration_s, 0.996, 1e-9);
    for (int k = 0; k < 8; ++k) {
      const double deviation = drawn.sigma[k] / std::sqrt(250.0);
      EXPECT_NEAR(figures.mean[k], drawn.mean[k], 5.5 * deviation + 0.004 * 1e4 + 0.1);
      EXPECT_NEAR(figures.sigma[k], drawn.sigma[k], 0.3 * drawn.sigma[k]);
      EXPECT_NEAR(figures.drift_per_s[k], drawn.drift_per_s[k], 5.5 * std::sqrt(12.0) * deviation);
    }
  }
}

TEST(ChannelWindow, OfFewSamplesItSaysWhatTheyTell) {
  ChannelWindow window;
  EXPECT_EQ(window.figures().samples, 0);
  EXPECT_FALSE(window.defect());
  window.add(ChannelVector::Constant(7.0), 1.0);
  EXPECT_EQ(window.figures().mean[3], 7.0);
  EXPECT_EQ(window.figures().sigma[3], 0.0);
  window.add(ChannelVector::Constant(9.0), 2.0);
  EXPECT_EQ(window.figures().mean[3], 8.0);
  EXPECT_EQ(window.figures().drift_per_s[3], 2.0);
}

TEST(ChannelWindow, NamesTheChannelAtItsEnd) {
  for (const double end : {kChannelEnd, -kChannelEnd, -kChannelEnd - 1.0}) {
    for (int channel = 0; channel < 8; ++channel) {
      ChannelWindow window;
      for (int k = 0; k < 100; ++k) {
        ChannelVector counts = ChannelVector::Constant(k);
        if (k == 40) counts[channel] = end;
        window.add(counts, 0.004 * k);
      }
      ASSERT_TRUE(window.defect());
      EXPECT_EQ(window.defect()->channel, channel);
      EXPECT_EQ(window.defect()->trouble, ChannelTrouble::kAtItsEnd);
      EXPECT_EQ(window.defect()->counts, end);
    }
  }
  ChannelWindow below;
  below.add(ChannelVector::Constant(kChannelEnd - 1.0), 0.0);
  EXPECT_FALSE(below.defect());
}

TEST(ChannelWindow, SeesAChannelThatStopsShortOfItsEnd) {
  test::Random random(12);
  for (int i = 0; i < 200; ++i) {
    DrawnChannels drawn;
    drawn.is_filtered = random.chance(0.5);
    drawn.sigma.setConstant(random.logUniform(10.0, 1e3));
    const ChannelFigures zero = drawnWindow(random, drawn, 1250).figures();
    drawn.mean = random.vector<ChannelVector>(8, -1e5, 1e5);
    drawn.mean[2] = 2e5;
    drawn.top = drawn.mean[2] + random.uniform(-3.0, 0.0) * drawn.sigma[2];
    const std::optional<ChannelDefect> defect = drawnWindow(random, drawn).defect(&zero);
    ASSERT_TRUE(defect);
    EXPECT_EQ(defect->channel, 2);
    EXPECT_EQ(defect->trouble, ChannelTrouble::kFlatTopped);
  }
}

/// Of 16 bits, as of 12 or 20, without the noise that shows a flat top.
TEST(ChannelWindow, NamesAQuietChannelAtTheEndOfANarrowerConverter) {
  for (const double end : {32767.0, -32768.0, -32767.0, 2047.0, 524287.0}) {
    ChannelWindow window, near;
    for (int k = 0; k < 100; ++k) {
      ChannelVector counts = ChannelVector::Constant(k % 2);
      counts[5] = end;
      window.add(counts, 0.004 * k);
      counts[5] = end - std::copysign(3.0, end);
      near.add(counts, 0.004 * k);
    }
    ASSERT_TRUE(window.defect());
    EXPECT_EQ(window.defect()->channel, 5);
    EXPECT_EQ(window.defect()->trouble, ChannelTrouble::kAtItsEnd);
    EXPECT_EQ(window.defect()->counts, end);
    EXPECT_FALSE(near.defect()) << end;
  }
}

/// Also without load, as by an offset that is too large: from then on it has no noise to judge by.
TEST(ChannelWindow, SeesAChannelThatIsStillWhileTheOthersRustle) {
  test::Random random(14);
  DrawnChannels drawn;
  drawn.mean[2] = 2e5;
  drawn.top = 1e5;
  const ChannelWindow window = drawnWindow(random, drawn);
  ASSERT_TRUE(window.defect());
  EXPECT_EQ(window.defect()->channel, 2);
  EXPECT_EQ(window.defect()->trouble, ChannelTrouble::kFlatTopped);
  EXPECT_EQ(window.defect()->counts, 1e5);
  drawn.sigma.setConstant(0.5);
  EXPECT_FALSE(drawnWindow(random, drawn).defect());
}

TEST(ChannelWindow, FiguresOfAFileShowIt) {
  ChannelFigures zero, push;
  zero.sigma.setConstant(30.0);
  push.sigma.setConstant(40.0);
  push.mean[1] = 3e5;
  EXPECT_FALSE(figuresDefect(zero));
  EXPECT_FALSE(figuresDefect(push, &zero));
  push.sigma[1] = 5.0;
  ASSERT_TRUE(figuresDefect(push, &zero));
  EXPECT_EQ(figuresDefect(push, &zero)->channel, 1);
  EXPECT_EQ(figuresDefect(push, &zero)->counts, 3e5);
  push.sigma[1] = 40.0;
  push.mean[1] = -kChannelEnd + 100.0;
  ASSERT_TRUE(figuresDefect(push, &zero));
  EXPECT_EQ(figuresDefect(push, &zero)->trouble, ChannelTrouble::kAtItsEnd);
}

/// As 16 bits in the upper ones of 24: with hardly any noise many samples are the outermost ones,
/// and some channels are still while others change between two steps.
TEST(ChannelWindow, HasNothingAgainstAGoodOneWhoseCountsComeInSteps) {
  test::Random random(15);
  for (int i = 0; i < 500; ++i) {
    DrawnChannels drawn;
    drawn.step = std::exp2(random.integer(1, 10));
    drawn.mean = random.vector<ChannelVector>(8, -30.0, 30.0) * drawn.step;
    drawn.sigma.setConstant(random.logUniform(0.15, 10.0) * drawn.step);
    const ChannelWindow unloaded = drawnWindow(random, drawn, 500);
    const ChannelFigures zero = unloaded.figures();
    EXPECT_FALSE(unloaded.defect());
    EXPECT_EQ(zero.step, drawn.step);
    drawn.mean = random.vector<ChannelVector>(8, -1e3, 1e3) * drawn.step;
    const ChannelWindow pushed = drawnWindow(random, drawn);
    EXPECT_FALSE(pushed.defect(&zero)) << i;
    EXPECT_FALSE(figuresDefect(pushed.figures(), &zero)) << i;
  }
}

TEST(ChannelWindow, SeesTheEndAndTheFlatTopOfCountsThatComeInSteps) {
  test::Random random(16);
  DrawnChannels drawn;
  drawn.step = 256.0;
  drawn.sigma.setConstant(0.4 * drawn.step);
  const ChannelFigures zero = drawnWindow(random, drawn).figures();
  for (const double top : {kChannelEnd + 1.0 - drawn.step, 2047.0 * drawn.step}) {
    drawn.top = top;
    drawn.mean[2] = top + 1e4;
    const std::optional<ChannelDefect> defect = drawnWindow(random, drawn).defect(&zero);
    ASSERT_TRUE(defect);
    EXPECT_EQ(defect->channel, 2);
    EXPECT_EQ(defect->trouble, ChannelTrouble::kAtItsEnd);
  }
  drawn.sigma.setConstant(20.0 * drawn.step);
  drawn.top = 1000.0 * drawn.step;
  drawn.mean[2] = 0.0;
  const ChannelFigures loud = drawnWindow(random, drawn).figures();
  drawn.mean[2] = drawn.top;
  const std::optional<ChannelDefect> defect = drawnWindow(random, drawn).defect(&loud);
  ASSERT_TRUE(defect);
  EXPECT_EQ(defect->trouble, ChannelTrouble::kFlatTopped);
}

/// A hand trembles, and noise comes filtered.
TEST(ChannelWindow, HasNothingAgainstAGoodOne) {
  test::Random random(13);
  for (int i = 0; i < 2000; ++i) {
    DrawnChannels drawn;
    drawn.is_filtered = random.chance(0.5);
    drawn.sigma.setConstant(random.logUniform(0.3, 1e3));
    const ChannelFigures zero = drawnWindow(random, drawn, 500).figures();
    drawn.mean = random.vector<ChannelVector>(8, -1e6, 1e6);
    drawn.drift_per_s = random.vector<ChannelVector>(8, -1e4, 1e4);
    if (random.chance(0.3)) drawn.sigma *= random.uniform(1.0, 20.0);
    EXPECT_FALSE(drawnWindow(random, drawn).defect(&zero)) << i;
  }
}

}  // namespace
}  // namespace tactus
