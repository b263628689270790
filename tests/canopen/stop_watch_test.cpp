#include "tactus/canopen/stop_watch.h"

#include <gtest/gtest.h>

#include "support/period.h"

namespace tactus {
namespace {

constexpr int kDeadline_cycles = 20;

/// Of a drive that rests but keeps its power: cycles of a quick stop until it is cut off.
int cyclesUntilCutOff(int before, int missed_cycles) {
  StopWatch watch(kDeadline_cycles, test::kPeriod_s);
  DriveReport report;
  int cycles = 0;
  while (!report.is_cut_off && cycles < 100) {
    if (cycles == before) watch.coast(missed_cycles);
    watch.update(DriveGoal::kQuickStop, false, false, 1, report);
    ++cycles;
  }
  return cycles;
}

TEST(StopWatch, CutsOffBehindItsDeadline) {
  EXPECT_EQ(cyclesUntilCutOff(0, 0), kDeadline_cycles + 1);
  EXPECT_EQ(cyclesUntilCutOff(5, 7), kDeadline_cycles + 1 - 7);
}

/// What it did in cycles that were missed is heard in the next three.
TEST(StopWatch, HearsADriveBeforeMissedCyclesMakeItLate) {
  for (const int missed : {13, 20, 1000, 2'000'000'000})
    EXPECT_EQ(cyclesUntilCutOff(5, missed), 5 + 3 + 1) << missed;
  EXPECT_EQ(cyclesUntilCutOff(18, 1000), kDeadline_cycles + 1) << "no later than without them";
}

TEST(StopWatch, LatchesADriveThatIgnoresItsStateLikewise) {
  StopWatch watch(kDeadline_cycles, test::kPeriod_s);
  DriveReport report;
  const auto ignore = [&](int cycles) {
    for (int i = 0; i < cycles; ++i) watch.update(DriveGoal::kDisabled, true, false, 1, report);
  };
  ignore(5);
  watch.coast(1000);
  ignore(3);
  EXPECT_EQ(report.fault, Fault::kNone);
  ignore(1);
  EXPECT_EQ(report.fault, Fault::kDriveStateLost);
}

}  // namespace
}  // namespace tactus
