#include "tactus/sim/simulated_module.h"

#include <gtest/gtest.h>

#include "support/crops9.h"
#include "support/random.h"
#include "support/tactile_samples.h"
#include "tactus/control/contact_point.h"

namespace tactus {
namespace {

constexpr double kFullScale_N = 8388607.0 / 100000.0;

SimulatedModuleConfig moduleConfig() { return test::crops9Plant({}).modules[0]; }

Wrench5 wrenchOf(double x_m, double F_y, double F_z) {
  return Wrench5{{F_y, F_z, -x_m * F_z, x_m * F_y, 0.0}};
}

TactileSample settle(SimulatedModule& module, const Wrench5& wrench) {
  for (int i = 0; i < 2000; ++i) module.update(wrench);
  return module.sample();
}

Wrench5 readings(const TactileSample& s) {
  return Wrench5{{s.force_y_N, s.force_z_N, s.moment_y_Nm, s.moment_z_Nm, s.moment_x_Nm}};
}

TEST(SimulatedModule, GivesTheContactBackThroughTwentyFourBits) {
  SimulatedModuleConfig config = moduleConfig();
  config.quantised = true;
  test::Random random(321);
  for (int i = 0; i < 100; ++i) {
    SimulatedModule module(config);
    const double x_m = random.uniform(0.0, 0.38);
    const double force_N = random.logUniform(0.5, 50.0);
    const double angle = random.uniform(-3.1, 3.1);
    const TactileSample sample =
        settle(module, wrenchOf(x_m, force_N * std::cos(angle), force_N * std::sin(angle)));
    ContactPointState contact;
    locateContact(sample, test::moduleOfLength(0.38), contact);
    const double quantum_N = 1.0 / config.channels.counts_per_N;
    EXPECT_NEAR(contact.force_N, force_N, 4.0 * quantum_N);
    EXPECT_NEAR(contact.position_m, x_m, 4.0 * 0.34 * quantum_N / force_N);
    EXPECT_NEAR(contact.direction.z(), std::sin(angle), 4.0 * quantum_N / force_N);
  }
}

/// Also where its row is not at right angles to the others.
TEST(SimulatedModule, GivesTheMomentAboutTheAxisBackIfItTellsIt) {
  test::Random random(322);
  for (int i = 0; i < 50; ++i) {
    SimulatedModuleConfig config = moduleConfig();
    config.filter_cutoff_hz = 100.0;
    Wrench5 wrench = wrenchOf(0.2, random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0));
    wrench[4] = random.uniform(-0.3, 0.3);
    SimulatedModule silent(config);
    EXPECT_EQ(settle(silent, wrench).moment_x_Nm, 0.0);
    config.channels.moment_x = random.vector<TactileChannelRow>(8, 0.01, 0.05);
    SimulatedModule telling(config);
    EXPECT_LT((readings(settle(telling, wrench)) - wrench).norm(), 1e-3);
    config.quantised = false;
    SimulatedModule exact(config);
    EXPECT_LT((readings(settle(exact, wrench)) - wrench).norm(), 1e-9);
  }
}

TEST(SimulatedModule, QuantisesEachChannel) {
  SimulatedModuleConfig config = moduleConfig();
  config.quantised = true;
  config.channels.counts_per_N = 10.0;
  SimulatedModule module(config);
  // 1.04 N in the middle of four cells: 2.6 counts each, which make 3.
  EXPECT_NEAR(settle(module, wrenchOf(0.19, 1.04, 0.0)).force_y_N, 1.2, 1e-12);
  EXPECT_NEAR(settle(module, wrenchOf(0.19, 0.96, 0.0)).force_y_N, 0.8, 1e-12);
  EXPECT_NEAR(settle(module, wrenchOf(0.19, -1.04, 0.0)).force_y_N, -1.2, 1e-12);
}

TEST(SimulatedModule, SaturatesItsChannels) {
  SimulatedModuleConfig config = moduleConfig();
  config.quantised = true;
  for (const double sign : {1.0, -1.0}) {
    SimulatedModule module(config);
    const TactileSample sample = settle(module, wrenchOf(0.19, sign * 1e5, 0.0));
    EXPECT_NEAR(sample.force_y_N, sign * 4.0 * kFullScale_N, 1e-9);
    EXPECT_NEAR(sample.moment_z_Nm, sign * 4.0 * kFullScale_N * 0.19, 1e-9);
    EXPECT_NEAR(sample.force_z_N, 0.0, 1e-9);
  }
}

TEST(SimulatedModule, IsTransparentWithoutNoiseAndQuantisation) {
  SimulatedModule module(moduleConfig());
  const Wrench5 wrench = wrenchOf(0.1, 3.0, -2.0);
  EXPECT_LT((readings(settle(module, wrench)) - wrench).norm(), 1e-9);
}

TEST(SimulatedModule, SamplesAtItsPeriodAndHoldsBetween) {
  SimulatedModule module(moduleConfig());
  EXPECT_EQ(module.sample().sequence, 0u);
  TactileSample before = module.sample();
  for (int step = 0; step < 400; ++step) {
    module.update(wrenchOf(0.1, 0.01 * step, 0.0));
    const TactileSample now = module.sample();
    if (step % 4 == 0) {
      EXPECT_EQ(now.sequence, before.sequence + 1);
    } else {
      EXPECT_EQ(now.sequence, before.sequence);
      EXPECT_EQ(now.force_y_N, before.force_y_N);
    }
    before = now;
  }
}

std::vector<Wrench5> noise(std::uint64_t seed, double noise_N, int count) {
  SimulatedModuleConfig config = moduleConfig();
  config.noise_N = noise_N;
  config.seed = seed;
  config.channels.sample_period_s = 0.001;
  SimulatedModule module(config);
  std::vector<Wrench5> samples;
  for (int i = 0; i < count; ++i) {
    module.update(Wrench5::Zero());
    samples.push_back(readings(module.sample()));
  }
  return samples;
}

TEST(SimulatedModule, LosesItsShareOfSamplesAndHoldsTheOneBefore) {
  SimulatedModuleConfig config = moduleConfig();
  config.lost_share = 0.3;
  SimulatedModule module(config);
  constexpr int kSamples = 10000;
  const auto steps_a_sample =
      static_cast<int>(std::lround(config.channels.sample_period_s * config.filter_rate_hz));
  TactileSample before;
  for (int i = 0; i < kSamples * steps_a_sample; ++i) {
    module.update(wrenchOf(0.1, 0.001 * i, 0.0));
    const TactileSample now = module.sample();
    if (now.sequence == before.sequence) {
      ASSERT_EQ(now.force_y_N, before.force_y_N);
    } else {
      ASSERT_EQ(now.sequence, before.sequence + 1) << "numbers are given to what is sent";
    }
    before = now;
  }
  EXPECT_NEAR(before.sequence, 0.7 * kSamples, 200.0);
  config.lost_share = 1.0;
  EXPECT_EQ(settle(module = SimulatedModule(config), wrenchOf(0.1, 1.0, 0.0)).sequence, 0u);
}

TEST(SimulatedModule, NoiseRepeatsWithItsSeed) {
  EXPECT_EQ(noise(7, 0.02, 200), noise(7, 0.02, 200));
  EXPECT_NE(noise(7, 0.02, 200), noise(8, 0.02, 200));
}

TEST(SimulatedModule, NoiseHasTheStandardDeviationOfEachChannel) {
  constexpr double kNoise_N = 0.03;
  constexpr int kCount = 20000;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  Wrench5 mean = Wrench5::Zero();
  for (const Wrench5& sample : noise(3, kNoise_N, kCount)) {
    covariance += sample.head<4>() * sample.head<4>().transpose() / kCount;
    mean += sample / kCount;
  }
  const Eigen::Matrix<double, 4, 8> C = moduleConfig().channels.calibration;
  const Eigen::Matrix4d expected = kNoise_N * kNoise_N * C * C.transpose();
  EXPECT_LT((covariance - expected).norm(), 0.03 * expected.norm());
  EXPECT_LT(mean.norm(), 4.0 * std::sqrt(expected.trace() / kCount));
}

}  // namespace
}  // namespace tactus
