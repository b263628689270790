#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "support/crops9.h"
#include "support/random.h"
#include "tactus/math/filter.h"
#include "tactus/sim/simulated_module.h"

/// What a real module does that a perfect one does not.
namespace tactus {
namespace {

SimulatedModuleConfig realModule() { return test::crops9Plant({}).modules[0]; }

Wrench5 forceAt(double x_m, double F_y, double F_z) {
  return Wrench5{{F_y, F_z, -x_m * F_z, x_m * F_y, 0.0}};
}

Wrench5 readingOf(const SimulatedModule& module) {
  const TactileSample& s = module.sample();
  return Wrench5{{s.force_y_N, s.force_z_N, s.moment_y_Nm, s.moment_z_Nm, s.moment_x_Nm}};
}

Wrench5 settled(SimulatedModule& module, const Wrench5& wrench, int steps = 2000) {
  for (int i = 0; i < steps; ++i) module.update(wrench);
  return readingOf(module);
}

TEST(ModuleErrors, GainsOfChannelsAreThoseOfTheCells) {
  SimulatedModuleConfig config = realModule();
  config.channel_gains.assign(8, 1.1);
  SimulatedModule all(config);
  const Wrench5 force = forceAt(0.1, 3.0, -2.0);
  EXPECT_LT((settled(all, force) - 1.1 * force).norm(), 1e-9);
  // The first ring's pair along y, at 0.04 m: a force there is felt by it alone, half by each.
  config.channel_gains = {2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  SimulatedModule one(config);
  EXPECT_LT((settled(one, forceAt(0.04, 4.0, 0.0)) - forceAt(0.04, 6.0, 0.0)).norm(), 1e-9);
  EXPECT_LT((settled(one, forceAt(0.34, 4.0, 0.0)) - forceAt(0.34, 4.0, 0.0)).norm(), 1e-9);
}

/// Noise and counts of a module that leaves the filter to its reader go through it, too.
TEST(ModuleErrors, GoThroughTheFilterOfAReaderThatHasIt) {
  SimulatedModuleConfig config = realModule();
  config.noise_N = 0.1;
  config.filter_place = FilterPlace::kNone;
  SimulatedModule raw(config);
  config.filter_place = FilterPlace::kReader;
  SimulatedModule read(config);
  std::vector<ButterworthLowPass> filters(
      5, ButterworthLowPass(config.filter_cutoff_hz, 1.0 / config.channels.sample_period_s));
  test::Random random(922);
  unsigned sample = 0;
  for (int step = 0; step < 4000; ++step) {
    const Wrench5 felt = forceAt(0.1, random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0));
    raw.update(felt);
    read.update(felt);
    if (raw.sample().sequence == sample) continue;
    sample = raw.sample().sequence;
    const Wrench5 unfiltered = readingOf(raw);
    for (int i = 0; i < 5; ++i)
      EXPECT_EQ(readingOf(read)[i], filters[i].update(unfiltered[i])) << step;
  }
  EXPECT_GT(sample, 900U);
}

TEST(ModuleErrors, ChannelsDriftFromTheStart) {
  SimulatedModuleConfig config = realModule();
  config.channel_drifts_N_per_s = {0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  SimulatedModule module(config);
  EXPECT_NEAR(settled(module, Wrench5::Zero(), 5001)[0], 0.5, 1e-3);
  EXPECT_NEAR(settled(module, Wrench5::Zero(), 5000)[0], 1.0, 1e-3);
}

TEST(ModuleErrors, TurnedCellsSeeForcesTurnedTheOtherWay) {
  SimulatedModuleConfig config = realModule();
  test::Random random(921);
  for (int i = 0; i < 20; ++i) {
    config.direction_error_rad = random.uniform(-3.0, 3.0);
    const double angle = random.uniform(-3.0, 3.0);
    const double seen = angle - config.direction_error_rad;
    SimulatedModule module(config);
    const Wrench5 felt =
        settled(module, forceAt(0.3, 2.0 * std::cos(angle), 2.0 * std::sin(angle)));
    EXPECT_LT((felt - forceAt(0.3, 2.0 * std::cos(seen), 2.0 * std::sin(seen))).norm(), 1e-9);
  }
}

TEST(ModuleErrors, ATareTakesAwayWhatIsFeltAtRestErrorsIncluded) {
  SimulatedModuleConfig config = realModule();
  config.channel_gains = {1.2, 0.9, 1.0, 1.1, 0.8, 1.0, 1.0, 1.05};
  config.direction_error_rad = 0.2;
  const Wrench5 weight = forceAt(0.19, 1.0, -4.0);
  SimulatedModule tared(config, weight);
  for (int i = 0; i < 400; ++i) {
    tared.update(weight);
    ASSERT_LT(readingOf(tared).norm(), 1e-9) << "nor does it ring";
  }
  config.tared = false;
  SimulatedModule raw(config, weight);
  SimulatedModule loaded(config);
  EXPECT_LT((settled(raw, weight, 1) - settled(loaded, weight)).norm(), 1e-9);
}

TEST(ModuleErrors, AChannelAtItsRailIsSeen) {
  SimulatedModuleConfig config = realModule();
  config.quantised = true;
  config.channels.counts_per_N = 1e6;  // rails at 8.39 N
  SimulatedModule module(config);
  settled(module, forceAt(0.19, 4.0 * 8.38, 0.0));
  EXPECT_FALSE(module.isSaturated());
  settled(module, forceAt(0.19, 0.0, -4.0 * 8.4));
  EXPECT_TRUE(module.isSaturated());
  settled(module, Wrench5::Zero());
  EXPECT_FALSE(module.isSaturated());
}

/// Steps after which each sample came, counted from when it was taken.
std::multiset<int> latenesses(double jitter_s, std::uint64_t seed) {
  SimulatedModuleConfig config = realModule();
  config.jitter_s = jitter_s;
  config.seed = seed;
  SimulatedModule module(config);
  std::multiset<int> result;
  std::uint32_t sequence = 0;
  for (int step = 0; step < 40000; ++step) {
    module.update(Wrench5::Zero());
    const std::uint32_t now = module.sample().sequence;
    if (now == sequence) continue;
    sequence = now;
    result.insert(step - 4 * static_cast<int>(now - 1));
  }
  return result;
}

TEST(ModuleErrors, SamplesJitterByAllThatTheyMayAndComeInOrder) {
  const std::multiset<int> late = latenesses(0.002, 5);
  EXPECT_EQ(late.size(), 10000u) << "none is lost";
  EXPECT_EQ(*late.begin(), 0);
  EXPECT_EQ(*late.rbegin(), 2);
  EXPECT_NEAR(static_cast<double>(late.count(1)), 5000.0, 300.0) << "rounded from 0.5 to 1.5 ms";
  EXPECT_EQ(late, latenesses(0.002, 5)) << "the same each time";
  EXPECT_EQ(latenesses(0.0, 5).count(0), 10000u);
  EXPECT_LE(*latenesses(0.02, 5).rbegin(), 4) << "at the latest with the next one";
}

}  // namespace
}  // namespace tactus
