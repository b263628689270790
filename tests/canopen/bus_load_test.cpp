#include "tactus/canopen/bus_load.h"

#include <gtest/gtest.h>

#include <string>

namespace tactus {
namespace {

HardwareConfig withDrives(int count, int bus) {
  HardwareConfig hardware;
  hardware.buses = {{"can0", 1e6}, {"can1", 1e6}};
  for (int i = 0; i < count; ++i)
    hardware.drives.push_back({.joint = i, .bus = bus, .node_id = i + 1});
  return hardware;
}

/// Without heartbeats, in bits a cycle of 1 ms.
double cyclicBits(const BusLoad& load) {
  double bits = 0.0;
  for (const BusLoadTerm& term : load.terms)
    if (term.name != std::string("heartbeats")) bits += term.bitsPerSecond() * 0.001;
  return bits;
}

/// Start, id, RTR, IDE, r0, length, data, CRC: 34 + 8 n bits that are stuffed, one bit more after
/// the first five and then after each four. Then delimiters, acknowledge, end and pause: 13.
TEST(BusLoad, CountsTheBitsOfTheLongestFrame) {
  for (int n = 0; n <= 8; ++n) {
    const int stuffed = 34 + 8 * n;
    EXPECT_EQ(worstCaseBits(n), stuffed + (stuffed - 1) / 4 + 13) << n;
  }
}

TEST(BusLoad, ThreeDrivesTake745BitsACycleAndFour975) {
  EXPECT_DOUBLE_EQ(cyclicBits(busLoads(withDrives(3, 0), 0.001)[0]), 745.0);
  EXPECT_DOUBLE_EQ(cyclicBits(busLoads(withDrives(4, 0), 0.001)[0]), 975.0);
}

TEST(BusLoad, ThreeDrivesWithHeartbeatsStayBelowTheLimitAndFourDoNot) {
  const BusLoad three = busLoads(withDrives(3, 1), 0.001)[1];
  EXPECT_DOUBLE_EQ(three.bitsPerSecond(), 745e3 + 4 * 65 / 0.02);
  EXPECT_DOUBLE_EQ(three.share(), 0.758);
  EXPECT_LT(three.share(), kMaxBusLoad);
  EXPECT_GT(busLoads(withDrives(4, 1), 0.001)[1].share(), kMaxBusLoad);
}

TEST(BusLoad, ABusWithoutDrivesHasNoSyncAndNoHeartbeat) {
  HardwareConfig hardware = withDrives(3, 0);
  EXPECT_TRUE(busLoads(hardware, 0.001)[1].terms.empty());
  EXPECT_EQ(busLoads(hardware, 0.001)[1].share(), 0.0);
  hardware.tactile_modules.emplace_back();
  hardware.tactile_modules.front().bus = 1;
  hardware.tactile_modules.front().channels.sample_period_s = 0.004;
  const BusLoad tactile = busLoads(hardware, 0.001)[1];
  ASSERT_EQ(tactile.terms.size(), 1u);
  EXPECT_DOUBLE_EQ(tactile.bitsPerSecond(), 4 * 135 / 0.004);
}

TEST(BusLoad, DrivesAndModuleOnOneBusAddUpAtAnotherRate) {
  HardwareConfig hardware = withDrives(1, 0);
  hardware.buses[0].bit_rate_per_s = 500e3;
  hardware.canopen.heartbeat_period_s = 0.1;
  hardware.tactile_modules.emplace_back();
  hardware.tactile_modules.front().channels.sample_period_s = 0.01;
  const BusLoad load = busLoads(hardware, 0.002)[0];
  EXPECT_DOUBLE_EQ(load.bitsPerSecond(), (115 + 115 + 55) / 0.002 + 2 * 65 / 0.1 + 4 * 135 / 0.01);
  EXPECT_DOUBLE_EQ(load.share(), load.bitsPerSecond() / 500e3);
}

}  // namespace
}  // namespace tactus
