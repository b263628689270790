#include "tactus/analysis/channel_range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/random.h"
#include "tactus/sim/simulated_module.h"

namespace tactus {
namespace {

constexpr double kCoverLength_m = 0.38;

/// Two rings of four cells, as crops9 has them; canted ones tell M_x, too.
TactileChannels ringsOfCells(bool canted) {
  TactileChannels channels;
  channels.calibration << 1, -1, 0, 0, 1, -1, 0, 0,  //
      0, 0, 1, -1, 0, 0, 1, -1,                      //
      0, 0, -0.04, 0.04, 0, 0, -0.34, 0.34,          //
      0.04, -0.04, 0, 0, 0.34, -0.34, 0, 0;
  if (canted) channels.moment_x = TactileChannelRow::Constant(0.03);
  return channels;
}

bool saturates(const TactileChannels& channels, double force_N, double x_m, double angle_rad) {
  SimulatedModuleConfig config;
  config.channels = channels;
  config.quantised = true;
  config.filter_cutoff_hz = 0.4 * config.filter_rate_hz;
  SimulatedModule module(config);
  const double y_N = force_N * std::cos(angle_rad), z_N = force_N * std::sin(angle_rad);
  for (int i = 0; i < 100; ++i) module.update(Wrench5{{y_N, z_N, -x_m * z_N, x_m * y_N, 0.0}});
  return module.isSaturated();
}

/// At its start F_y = 1 is 0.34 / 0.30 on the near ring, half of it on each cell of the pair.
TEST(ChannelRange, IsKnownByHandForRingsOfCells) {
  const double force_N = 83.88607 / (0.5 * 0.34 / 0.30);
  EXPECT_NEAR(railForce_N(ringsOfCells(false), kCoverLength_m), force_N, 1e-9);
  TactileChannels finer = ringsOfCells(false);
  finer.counts_per_N = 1e7;
  EXPECT_NEAR(railForce_N(finer, kCoverLength_m), 0.01 * force_N, 1e-9);
}

/// Of any calibration: nowhere and in no direction it ends sooner, somewhere it does end there.
TEST(ChannelRange, IsWhereTheFirstChannelOfASimulatedModuleEnds) {
  test::Random random(410);
  for (int i = 0; i < 12; ++i) {
    TactileChannels channels = ringsOfCells(i % 2 == 1);
    for (int k = 0; i > 1 && k < 32; ++k)
      channels.calibration.data()[k] += random.vector(1, -0.05, 0.05)[0];
    const double force_N = railForce_N(channels, kCoverLength_m);
    bool has_ended = false;
    for (const double x_m : {0.0, 0.1, 0.19, 0.3, kCoverLength_m}) {
      for (int k = 0; k < 180; ++k) {
        const double angle_rad = k * std::numbers::pi / 90.0;
        EXPECT_FALSE(saturates(channels, 0.999 * force_N, x_m, angle_rad)) << i << " at " << x_m;
        has_ended |= saturates(channels, 1.002 * force_N, x_m, angle_rad);
      }
    }
    EXPECT_TRUE(has_ended) << i;
  }
}

}  // namespace
}  // namespace tactus
