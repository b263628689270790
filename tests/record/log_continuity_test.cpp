#include "tactus/record/log_continuity.h"

#include <gtest/gtest.h>

#include "support/random_robot.h"

namespace tactus {
namespace {

ControllerConfig someArm() {
  test::Random random(1);
  return test::randomController(random, 3, 2);
}

/// One cycle a call, with a period of 1 ms.
class LogContinuityTest : public ::testing::Test {
 protected:
  bool add(int cycle, Mode mode = Mode::kRunning, std::uint64_t missed = 0) {
    CycleRecord record;
    record.t_s = 0.001 * cycle;
    record.mode = static_cast<std::uint64_t>(mode);
    record.missed_cycles = missed;
    return continuity_.add(record);
  }

  /// Cycles of running, none of which is known.
  void runUnknown(int cycles, int& cycle) {
    for (int i = 0; i < cycles; ++i) ASSERT_FALSE(add(cycle++));
  }

  void expectStretch(std::size_t index, double from_s, double to_s, const std::string& reason) {
    ASSERT_LT(index, continuity_.stretches().size());
    const UnknownStretch& stretch = continuity_.stretches()[index];
    EXPECT_NEAR(stretch.from_s, from_s, 1e-12);
    EXPECT_NEAR(stretch.to_s, to_s, 1e-12);
    EXPECT_EQ(stretch.reason, reason);
  }

  ControllerConfig config_ = someArm();
  LogContinuity continuity_{config_, 0.001, true};
};

TEST_F(LogContinuityTest, MissedCyclesLoseNothing) {
  EXPECT_TRUE(add(0));
  EXPECT_TRUE(add(1));
  EXPECT_TRUE(add(5, Mode::kRunning, 3));
  EXPECT_EQ(continuity_.missedCycles(), 3);
  EXPECT_TRUE(add(6));
  EXPECT_EQ(continuity_.missedCycles(), 0);
  EXPECT_TRUE(continuity_.stretches().empty());
}

/// Of a module that is silent since before.
TEST_F(LogContinuityTest, TheAgeOfASampleFromBeforeMissingRecordsIsUnknown) {
  CycleRecord record;
  const auto addWith = [&](int cycle, Mode mode, std::uint64_t first, std::uint64_t second) {
    record.t_s = 0.001 * cycle;
    record.mode = static_cast<std::uint64_t>(mode);
    record.tactile_sequence[0] = first;
    record.tactile_sequence[1] = second;
    return continuity_.add(record);
  };
  EXPECT_TRUE(addWith(0, Mode::kRunning, 7, 3));
  EXPECT_FALSE(addWith(5, Mode::kRunning, 8, 3));
  EXPECT_FALSE(addWith(6, Mode::kRunning, 9, 3));
  EXPECT_FALSE(addWith(7, Mode::kFault, 9, 3)) << "nothing new of the second module";
  EXPECT_FALSE(addWith(8, Mode::kRunning, 9, 4));
  EXPECT_TRUE(addWith(9, Mode::kFault, 9, 4));
  EXPECT_TRUE(addWith(10, Mode::kRunning, 9, 4)) << "it may be silent now";
}

TEST_F(LogContinuityTest, MissingRecordsLoseTheStateUntilAModeResetsIt) {
  EXPECT_TRUE(add(0));
  EXPECT_FALSE(add(10, Mode::kRunning, 3));  // three of nine
  EXPECT_FALSE(add(11, Mode::kHolding));
  EXPECT_FALSE(add(12, Mode::kStopping));
  EXPECT_TRUE(add(13, Mode::kReady));
  EXPECT_TRUE(add(14, Mode::kRunning));
  EXPECT_TRUE(add(15, Mode::kRunning));
  ASSERT_EQ(continuity_.stretches().size(), 1u);
  expectStretch(0, 0.001, 0.012, "records are missing");
}

TEST_F(LogContinuityTest, TheModeBeforeMissingRecordsIsUnknown) {
  EXPECT_TRUE(add(0, Mode::kFault));
  EXPECT_FALSE(add(5, Mode::kRunning)) << "it may have run for some cycles by then";
  EXPECT_FALSE(add(6, Mode::kRunning));
}

TEST_F(LogContinuityTest, ASecondGapIsPartOfTheSameStretch) {
  add(0);
  EXPECT_FALSE(add(5));
  EXPECT_FALSE(add(9));
  EXPECT_TRUE(add(10, Mode::kFault));
  EXPECT_FALSE(add(15, Mode::kFault));  // what came to the sensor meanwhile is unknown
  EXPECT_FALSE(add(20));
  ASSERT_EQ(continuity_.stretches().size(), 2u);
  expectStretch(0, 0.001, 0.009, "records are missing");
  expectStretch(1, 0.011, 0.020, "records are missing");
}

TEST_F(LogContinuityTest, TheFirstRecordsMayBeMissingToo) {
  EXPECT_FALSE(add(3));
  expectStretch(0, 0.0, 0.003, "records are missing");
}

TEST_F(LogContinuityTest, TimeThatDoesNotGoOnIsNoRun) {
  EXPECT_TRUE(add(0));
  EXPECT_TRUE(add(1));
  EXPECT_FALSE(add(1));
  EXPECT_FALSE(add(0));
  EXPECT_FALSE(add(1)) << "goes on, but from where?";
}

TEST_F(LogContinuityTest, ALaterPartBeginsUnknown) {
  continuity_.beginPart(2);
  EXPECT_FALSE(add(50, Mode::kRunning, 2));
  EXPECT_FALSE(add(51));
  continuity_.beginPart(3);
  EXPECT_FALSE(add(52));
  EXPECT_TRUE(add(53, Mode::kFault));
  ASSERT_EQ(continuity_.stretches().size(), 1u);
  expectStretch(0, 0.048, 0.052, "the part before is missing");
}

TEST_F(LogContinuityTest, ALaterPartThatBeginsInAFaultIsUnknownUntilTheNextOne) {
  continuity_.beginPart(2);
  EXPECT_FALSE(add(50, Mode::kFault));
  EXPECT_FALSE(add(51));
  EXPECT_TRUE(add(52, Mode::kFault));
}

TEST_F(LogContinuityTest, PartsInARowAreOneRun) {
  continuity_.beginPart(0);
  EXPECT_TRUE(add(0));
  continuity_.beginPart(1);
  EXPECT_TRUE(add(1));
  continuity_.beginPart(3);
  EXPECT_FALSE(add(4));
  expectStretch(0, 0.002, 0.004, "the part before is missing");
}

TEST_F(LogContinuityTest, AWayOutOfALimitsZoneIsKnownAfterTwoSecondsOfRunning) {
  config_.has_joint_limit_avoidance = true;
  continuity_ = LogContinuity(config_, 0.001, true);
  EXPECT_TRUE(add(0));
  int cycle = 10;
  runUnknown(1900, cycle);
  EXPECT_FALSE(add(cycle++, Mode::kFault));
  runUnknown(2001, cycle);
  EXPECT_TRUE(add(cycle++, Mode::kFault));
}

TEST_F(LogContinuityTest, AHoldBeginsThoseSecondsAnew) {
  config_.has_joint_limit_avoidance = true;
  continuity_ = LogContinuity(config_, 0.001, true);
  EXPECT_TRUE(add(0));
  int cycle = 10;
  runUnknown(1900, cycle);
  EXPECT_FALSE(add(cycle++, Mode::kHolding));
  runUnknown(200, cycle);
  EXPECT_FALSE(add(cycle++, Mode::kFault));
  runUnknown(2100, cycle);
  EXPECT_TRUE(add(cycle++, Mode::kFault));
}

TEST_F(LogContinuityTest, WithoutTheNumberEachGapIsTakenForMissedCycles) {
  continuity_ = LogContinuity(config_, 0.001, false);
  EXPECT_TRUE(add(0));
  EXPECT_TRUE(add(5));
  EXPECT_EQ(continuity_.missedCycles(), 4);
  EXPECT_TRUE(add(4));
  EXPECT_EQ(continuity_.missedCycles(), 0);
  EXPECT_TRUE(add(2'000'000));
  EXPECT_EQ(continuity_.missedCycles(), 0) << "no loop goes on after that";
}

}  // namespace
}  // namespace tactus
