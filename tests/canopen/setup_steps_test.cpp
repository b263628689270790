#include <gtest/gtest.h>

#include <cmath>
#include <ios>
#include <optional>
#include <set>
#include <stdexcept>

#include "support/random.h"
#include "tactus/canopen/drive_setup.h"
#include "tactus/canopen/velocity_counts.h"

namespace tactus {
namespace {

TEST(InterpolationPeriod, IsExactOrRefused) {
  EXPECT_EQ(interpolationPeriod(0.001), (InterpolationPeriod{1, -3}));
  EXPECT_EQ(interpolationPeriod(0.0005), (InterpolationPeriod{5, -4}));
  EXPECT_EQ(interpolationPeriod(0.002), (InterpolationPeriod{2, -3}));
  EXPECT_EQ(interpolationPeriod(0.01), (InterpolationPeriod{10, -3})) << "ms where they are whole";
  EXPECT_EQ(interpolationPeriod(0.255), (InterpolationPeriod{255, -3}));
  EXPECT_EQ(interpolationPeriod(0.26), (InterpolationPeriod{26, -2}));
  EXPECT_EQ(interpolationPeriod(0.00125), (InterpolationPeriod{125, -5}));
  EXPECT_EQ(interpolationPeriod(0.000125), (InterpolationPeriod{125, -6}));
  EXPECT_EQ(interpolationPeriod(20.0), (InterpolationPeriod{20, 0}));
  EXPECT_EQ(interpolationPeriod(123e-9), (InterpolationPeriod{123, -9}));
  for (double period_s : {0.001 / 3.0, 0.00333, 0.0, -0.001, std::nan(""), HUGE_VAL, 1e-12})
    EXPECT_EQ(interpolationPeriod(period_s), std::nullopt) << period_s;
  for (int value = 1; value <= 255; ++value) {
    for (int exponent = -6; exponent <= 0; ++exponent) {
      const double period_s = value * std::pow(10.0, exponent);
      const auto period = interpolationPeriod(period_s);
      ASSERT_TRUE(period) << period_s;
      EXPECT_DOUBLE_EQ(period->value * std::pow(10.0, period->exponent), period_s);
    }
  }
}

TEST(SetupSteps, AreRefusedWhereDrivesCannotBeTold) {
  EXPECT_THROW(setupSteps({}, {}, 0.001 / 3.0), std::invalid_argument);
  for (double bad_s : {0.0, 0.0004, 66.0, -1.0, std::nan("")}) {
    CanopenConfig canopen;
    canopen.heartbeat_period_s = bad_s;
    EXPECT_THROW(setupSteps({}, canopen, 0.001), std::invalid_argument) << bad_s;
    canopen = {};
    canopen.heartbeat_timeout_s = bad_s;
    EXPECT_THROW(setupSteps({}, canopen, 0.001), std::invalid_argument) << bad_s;
  }
}

/// Where a drive watches them, setpoints may stay away no longer than the heartbeat.
TEST(SetupSteps, GiveSetpointsADeadlineBeforeTheyAreValid) {
  CanopenConfig canopen;
  canopen.heartbeat_timeout_s = 0.123;
  int found = 0;
  bool is_valid = true;
  for (const SetupStep& step : setupSteps({}, canopen, 0.001)) {
    const bool is_id = step.entry.index == 0x1400 && step.entry.subindex == 1;
    if (is_id) is_valid = step.kind == SetupStep::Kind::kWrite;
    if (step.entry.index != 0x1400 || step.entry.subindex != 5) continue;
    ++found;
    EXPECT_FALSE(is_valid);
    EXPECT_EQ(step.value, 123u);
    EXPECT_EQ(step.entry.size, 2);
    EXPECT_EQ(step.need, SetupStep::Need::kIfWritable);
  }
  EXPECT_EQ(found, 1);
}

/// Bytes of an object by CiA 301 and CiA 402: a drive refuses any other number.
int bytesOf(const ObjectEntry& entry) {
  const bool is_mapping = (entry.index & 0xFE00) == 0x1600 || (entry.index & 0xFE00) == 0x1A00;
  if (is_mapping) return entry.subindex == 0 ? 1 : 4;
  const bool is_pdo = (entry.index & 0xFE00) == 0x1400 || (entry.index & 0xFE00) == 0x1800;
  if (is_pdo) return entry.subindex == 1 ? 4 : entry.subindex == 2 ? 1 : 2;
  switch (entry.index) {
    case 0x1000:  // device type, consumer heartbeat time, unit of velocities
    case 0x1016:
    case 0x607F:  // max profile velocity
    case 0x60A9:
    case 0x60B1:  // velocity offset
      return 4;
    case 0x6060:  // modes of operation, and its display
    case 0x6061:
    case 0x60C2:  // interpolation time period
      return 1;
    default:  // heartbeat time, control word, option codes, torque offset
      return 2;
  }
}

TEST(SetupSteps, HaveTheSizesOfTheStandards) {
  int steps = 0;
  for (const SetupStep& step : setupSteps({}, {}, 0.001)) {
    EXPECT_EQ(step.entry.size, bytesOf(step.entry))
        << std::hex << step.entry.index << ":" << int{step.entry.subindex};
    ++steps;
  }
  EXPECT_GT(steps, 25);
}

/// A stray frame may not move a drive, and the load of a bus is calculated without what drives send
/// by default; not all of them have it.
TEST(SetupSteps, StopTheOtherPdosThatADriveMayHave) {
  for (const int index : {0x1401, 0x1402, 0x1403, 0x1801, 0x1802, 0x1803}) {
    int stops = 0;
    for (const SetupStep& step : setupSteps({}, {}, 0.001)) {
      if (step.entry.index != index) continue;
      EXPECT_EQ(step.kind, SetupStep::Kind::kEnsure);
      EXPECT_GE(step.need, SetupStep::Need::kIfThere);
      ++stops;
    }
    EXPECT_EQ(stops, 1) << std::hex << index;
  }
}

/// Whole milliseconds of 16 bits, both ends among them.
TEST(SetupSteps, TellHeartbeatsOfAnyLengthThatDrivesCanHold) {
  for (const int ms : {1, 2, 65534, 65535}) {
    CanopenConfig canopen;
    canopen.heartbeat_period_s = canopen.heartbeat_timeout_s = 0.001 * ms;
    int told = 0;
    for (const SetupStep& step : setupSteps({}, canopen, 0.001)) {
      const bool is_produced = step.entry.index == 0x1017;
      const bool is_consumed = step.entry.index == 0x1016;
      if (!is_produced && !is_consumed) continue;
      EXPECT_EQ(step.value & 0xFFFF, static_cast<std::uint32_t>(ms));
      ++told;
    }
    EXPECT_EQ(told, 2);
  }
}

/// All that 60FF is ever told passes, with what rounding carried over, and a tenth more.
TEST(SetupSteps, LimitTheDriveToTheFastestThatItIsTold) {
  test::Random random(607);
  for (int i = 0; i < 2000; ++i) {
    DriveConfig drive;
    drive.counts_per_unit = std::exp(random.uniform(0.0, 15.0));
    drive.max_velocity = random.chance(0.3) ? random.index(9) + 1.0 : random.uniform(0.001, 10.0);
    std::int64_t limit = -1;
    for (const SetupStep& step : setupSteps(drive, {}, 0.001)) {
      if (step.entry.index != 0x607F) continue;
      limit = step.value;
      EXPECT_EQ(step.need, SetupStep::Need::kIfTaken);
    }
    VelocityCounts counts(drive.counts_per_unit);
    for (int cycle = 0; cycle < 50; ++cycle) {
      const bool is_fastest = random.chance(0.7);
      const std::int64_t told =
          counts.next(is_fastest ? drive.max_velocity : random.uniform(0.0, drive.max_velocity));
      ASSERT_LE(told, limit);
    }
    ASSERT_NEAR(static_cast<double>(limit), 1.1 * drive.max_velocity * drive.counts_per_unit, 1.0);
  }
}

TEST(SetupSteps, LimitNoDriveWhoseJointOrProfileHasNoLimit) {
  DriveConfig endless;
  DriveConfig otherwise;
  otherwise.max_velocity = 1.0;
  otherwise.has_speed_limit = false;
  for (const DriveConfig& drive : {endless, otherwise})
    for (const SetupStep& step : setupSteps(drive, {}, 0.001)) EXPECT_NE(step.entry.index, 0x607F);
}

TEST(SetupSteps, StopEachPdoOnce) {
  constexpr std::uint32_t kNotValid = 0x80000000;
  std::set<int> stopped;
  for (const SetupStep& step : setupSteps({}, {}, 0.001)) {
    if (step.kind != SetupStep::Kind::kEnsure || step.mask != kNotValid) continue;
    EXPECT_EQ(step.value, kNotValid);
    EXPECT_TRUE(stopped.insert(step.entry.index).second) << std::hex << step.entry.index;
  }
  EXPECT_EQ(stopped.size(), 8u);
}

}  // namespace
}  // namespace tactus
