#include "tactus/canopen/bus_load.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tactus/canopen/moteus_frames.h"

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

TEST(BusLoad, IsToldOfEachBus) {
  for (const std::size_t buses : {0u, 1u, 2u, 5u}) {
    HardwareConfig hardware;
    hardware.buses.resize(buses);
    EXPECT_EQ(busLoads(hardware, 0.001).size(), buses);
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

TEST(BusLoad, CountsTheFramesThatMayComeInACycle) {
  HardwareConfig hardware = withDrives(3, 0);
  EXPECT_EQ(busLoads(hardware, 0.001)[0].framesACycle(0.001), 3 + 3 + 1 + 4);
  hardware.tactile_modules.emplace_back();
  hardware.tactile_modules.front().channels.sample_period_s = 0.004;
  EXPECT_EQ(busLoads(hardware, 0.001)[0].framesACycle(0.001), 11 + 4);
  EXPECT_EQ(busLoads(hardware, 0.01)[0].framesACycle(0.01), 11 + 3 * 4);
  EXPECT_EQ(busLoads(hardware, 0.02)[0].framesACycle(0.02), 11 + 5 * 4);
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
  EXPECT_DOUBLE_EQ(cyclicBits(busLoads(hardware, 0.001)[0]), 745.0) << "it is on the other";
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

TEST(BusLoad, OfMoteusIsACommandAndAReplyEach) {
  for (const int drives : {1, 3}) {
    HardwareConfig hardware = withDrives(drives, 1);
    for (DriveConfig& drive : hardware.drives) drive.kind = DriveKind::kMoteus;
    hardware.buses[1].data_bit_rate_per_s = 5e6;
    EXPECT_TRUE(busLoads(hardware, 0.001)[0].terms.empty());
    const BusLoad load = busLoads(hardware, 0.001)[1];
    ASSERT_EQ(load.terms.size(), 2u);
    double bits = 0.0;
    for (const int bytes : {kMoteusCommandBytes, kMoteusReplyBytes}) {
      const FdBits worst = worstCaseFdBits(bytes, true);
      bits += worst.arbitration + worst.data / 5.0;
    }
    EXPECT_DOUBLE_EQ(load.bitsPerSecond(), drives * bits / 0.001);
  }
}

TEST(FdSize, IsTheSmallestThatALengthCodeHas) {
  const std::vector<int> sizes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  for (int n = 0; n <= 64; ++n)
    EXPECT_EQ(fdSize(n), *std::lower_bound(sizes.begin(), sizes.end(), n)) << n;
}

/// The bits of a CAN FD frame, with stuff bits where they come, by ISO 11898-1:2015.
FdBits bitsOf(std::uint32_t id, bool is_extended, const std::vector<std::uint8_t>& data) {
  std::vector<int> bits;
  const auto put = [&bits](std::uint32_t value, int count) {
    for (int i = count - 1; i >= 0; --i) bits.push_back(static_cast<int>(value >> i & 1));
  };
  put(0, 1);  // start
  if (is_extended) {
    put(id >> 18, 11);
    put(3, 2);  // SRR, IDE
    put(id & 0x3FFFF, 18);
    put(0, 1);  // RRS
  } else {
    put(id, 11);
    put(0, 2);  // RRS, IDE
  }
  put(5, 3);  // FDF, reserved, BRS
  const std::size_t slow = bits.size();
  put(0, 1);  // ESI
  const auto n = static_cast<std::uint32_t>(data.size());
  put(n <= 8 ? n : n <= 24 ? 9 + (n - 12) / 4 : n == 32 ? 13 : n == 48 ? 14 : 15, 4);
  for (const std::uint8_t byte : data) put(byte, 8);
  FdBits count;
  int run = 0, last = -1;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    int& phase = i < slow ? count.arbitration : count.data;
    ++phase;
    run = bits[i] == last ? run + 1 : 1;
    last = bits[i];
    if (run < 5) continue;
    ++phase;
    last = 1 - last;
    run = 1;
  }
  const int crc = n <= 16 ? 17 : 21;
  count.data += 4 + crc + 1 + (4 + crc - 1) / 4;  // one fixed stuff bit before, and after each four
  count.arbitration += 13;
  return count;
}

/// No frame takes longer, at whatever ratio of the rates, and the longest are not far off.
TEST(FdBits, AreNeverExceededAndHardlyMissed) {
  std::mt19937 random(3);
  for (const int n : {0, 1, 5, 8, 12, 16, 20, 24, 32, 48, 64}) {
    for (const bool is_extended : {false, true}) {
      const FdBits worst = worstCaseFdBits(n, is_extended);
      double closest = 0.0;
      for (int run = 0; run < 300; ++run) {
        const auto fill = static_cast<std::uint8_t>(run % 3 == 0   ? 0x00
                                                    : run % 3 == 1 ? 0x78
                                                                   : 0xC3);
        std::vector<std::uint8_t> data(static_cast<std::size_t>(n), fill);
        if (run % 4 == 0)
          for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
        const std::uint32_t mask = is_extended ? 0x1FFFFFFF : 0x7FF;
        const auto bits = static_cast<std::uint32_t>(random() & random());
        const std::uint32_t id = run % 5 == 0 ? 0 : bits & mask;
        const FdBits actual = bitsOf(id, is_extended, data);
        for (const double ratio : {1.0, 5.0, 8.0}) {
          const double time = actual.arbitration + actual.data / ratio;
          EXPECT_LE(time, worst.arbitration + worst.data / ratio) << n << " " << id;
        }
        closest = std::max<double>(closest, actual.arbitration + actual.data);
      }
      EXPECT_GT(closest, 0.89 * (worst.arbitration + worst.data)) << n << " " << is_extended;
    }
  }
}

TEST(FdBits, OfATermCountByTheirRates) {
  const FdBits bits = worstCaseFdBits(18, true);
  EXPECT_EQ(bits, worstCaseFdBits(20, true)) << "padded";
  const BusLoadTerm term{"query", 3, 18, 0.001, FdTiming{5.0, true}};
  EXPECT_DOUBLE_EQ(term.bitsAFrame(), bits.arbitration + bits.data / 5.0);
  EXPECT_DOUBLE_EQ(term.bitsPerSecond(), 3e3 * term.bitsAFrame());
  EXPECT_DOUBLE_EQ((BusLoadTerm{"RPDO1", 3, 6, 0.001}).bitsAFrame(), 115.0);
}

}  // namespace
}  // namespace tactus
