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
  EXPECT_EQ(cyclesUntilCutOff(1, 7), kDeadline_cycles + 1 - 7);
  EXPECT_EQ(cyclesUntilCutOff(0, 7), kDeadline_cycles + 1) << "missed before it began";
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

/// A drive that slows down, for 60 cycles of 1 ms; then it has got so much further, and rests.
bool movesOnAfterAStep(double step_rad, bool has_missed_cycles, DriveGoal meanwhile) {
  StopWatch watch(1000, test::kPeriod_s);
  DriveReport report;
  for (int cycle = 0; cycle < 200; ++cycle) {
    report.position += cycle < 60 ? 2e-4 : cycle == 60 ? step_rad : 0.0;
    if (cycle == 60 && has_missed_cycles) watch.coast(30);
    watch.update(cycle == 60 ? meanwhile : DriveGoal::kQuickStop, false, false, 1, report);
    if (report.is_moving_on) return true;
  }
  return false;
}

TEST(StopWatch, SeesNoMotionOnInAStepThatNobodyHasWatched) {
  EXPECT_TRUE(movesOnAfterAStep(0.02, false, DriveGoal::kQuickStop));
  EXPECT_FALSE(movesOnAfterAStep(0.0, false, DriveGoal::kQuickStop));
  EXPECT_FALSE(movesOnAfterAStep(0.02, true, DriveGoal::kQuickStop)) << "in missed cycles";
  EXPECT_FALSE(movesOnAfterAStep(0.02, false, DriveGoal::kEnabled)) << "it was to move";
}

}  // namespace
}  // namespace tactus
