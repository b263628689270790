#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "support/drive_rig.h"

/// Drives that do not stop, or lie about it.
namespace tactus {
namespace {

using test::DriveRig;
using test::kNode;
using test::rawFrame;
using test::ScriptedDrive;

constexpr int kDeadlineCycles = 500;
const CanFrame kNmtStop = rawFrame(0, {2, kNode});
const CanFrame kResetNode = rawFrame(0, {129, kNode});
const CanFrame kResetCommunication = rawFrame(0, {130, kNode});

/// A drive that moves, and obeys no control word from now on.
DriveRig deafDrive(double velocity) {
  DriveRig rig;
  rig.enable();
  rig.cycles(30, DriveGoal::kEnabled, velocity);
  rig.slave.ignores_commands = true;
  return rig;
}

bool isAmong(const CanFrame& frame, const std::vector<CanFrame>& frames) {
  return std::find(frames.begin(), frames.end(), frame) != frames.end();
}

std::vector<CanFrame> released(const DriveRig& rig) {
  FrameBatch out;
  rig.drive.release(out);
  return {out.begin(), out.end()};
}

TEST(DriveStop, OneThatMovesOnIsSeenAndStoppedByNmtLongBeforeTheDeadline) {
  for (const double velocity : {0.05, -0.3, 2.0}) {
    DriveRig rig = deafDrive(velocity);
    int cycles = 0;
    while (!rig.report().is_moving_on && cycles < kDeadlineCycles) {
      EXPECT_FALSE(isAmong(kNmtStop, rig.cycle(DriveGoal::kQuickStop)) && cycles < 90);
      ++cycles;
    }
    EXPECT_LE(cycles, 110) << velocity;
    rig.cycles(3, DriveGoal::kQuickStop);
    EXPECT_EQ(rig.slave.nmt, 4);
    EXPECT_NE(rig.slave.power, ScriptedDrive::kEnabled);
  }
}

TEST(DriveStop, OneThatWasNotHeardOfWhileItSlowedDownDoesNotMoveOn) {
  DriveRig rig;
  rig.slave.quick_stop_cycles = 120;
  rig.enable();
  rig.cycles(30, DriveGoal::kEnabled, 0.3);
  rig.slave.sends_feedback = false;
  rig.cycles(95, DriveGoal::kQuickStop);
  rig.slave.position -= 4000;  // 20 mrad on
  rig.slave.sends_feedback = true;
  for (int i = 0; i < 500; ++i) {
    ASSERT_FALSE(isAmong(kNmtStop, rig.cycle(DriveGoal::kQuickStop))) << i;
    ASSERT_FALSE(rig.report().is_moving_on) << i;
  }
  EXPECT_TRUE(rig.report().is_off);
}

/// Its way while nobody heard of it is none of the windows in which it was heard.
TEST(DriveStop, OneThatIsHeardAgainAfterAWhileDoesNotMoveOn) {
  DriveRig rig;
  rig.slave.quick_stop_cycles = 1000;
  rig.enable();
  rig.cycles(30, DriveGoal::kEnabled, 0.3);
  const double from = rig.slave.position;
  for (int i = 0; i < 490; ++i) {
    const double t_s = 0.001 * i;
    rig.slave.position = static_cast<int>(from - 2e5 * (0.3 * t_s - 0.25 * t_s * t_s));
    rig.slave.sends_feedback = i < 115 || i > 190;
    rig.cycle(DriveGoal::kQuickStop);
    ASSERT_FALSE(rig.report().is_moving_on) << i;
  }
}

TEST(DriveStop, OneThatIsNotSeenOffIsCutOffAtTheDeadline) {
  DriveRig rig;
  rig.enable();
  rig.slave.ignores_commands = rig.slave.ignores_nmt = true;  // at rest, but with power
  for (int i = 0; i < kDeadlineCycles; ++i) {
    ASSERT_FALSE(isAmong(kNmtStop, rig.cycle(DriveGoal::kQuickStop))) << i;
    ASSERT_FALSE(rig.drive.needsSilence()) << i;
  }
  EXPECT_EQ(rig.cycle(DriveGoal::kQuickStop), std::vector{kNmtStop});
  EXPECT_TRUE(rig.report().is_cut_off);
  int cycles = 0;
  for (; !rig.drive.needsSilence() && cycles < 100; ++cycles) {
    for (const CanFrame& frame : rig.cycle(DriveGoal::kQuickStop)) EXPECT_EQ(frame, kNmtStop);
  }
  EXPECT_LE(cycles, Drive::kCuttingOffCycles);
  rig.cycles(1000, DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.drive.needsSilence());
  rig.slave.ignores_commands = rig.slave.ignores_nmt = false;
  rig.enable();  // by a restart all is as before
  EXPECT_FALSE(rig.drive.needsSilence());
  EXPECT_FALSE(rig.report().is_cut_off);
}

TEST(DriveStop, OneThatIsSeenOffIsNeverCutOff) {
  DriveRig rig;
  rig.enable();
  for (int i = 0; i < 3 * kDeadlineCycles; ++i)
    ASSERT_FALSE(isAmong(kNmtStop, rig.cycle(DriveGoal::kQuickStop))) << i;
  rig.slave.sends_feedback = false;  // off when last heard of
  rig.cycles(1000, DriveGoal::kQuickStop);
  EXPECT_FALSE(rig.report().is_cut_off);
}

TEST(DriveStop, OneThatStaysEnabledThoughDisabledIsAFault) {
  DriveRig rig = deafDrive(0.1);
  int cycles = 0;
  while (rig.report().fault == Fault::kNone && cycles < 2 * kDeadlineCycles) {
    rig.cycle(DriveGoal::kDisabled);
    ++cycles;
  }
  EXPECT_EQ(rig.report().fault, Fault::kDriveStateLost);
  EXPECT_EQ(cycles, kDeadlineCycles + 1);
}

TEST(DriveStop, OneThatSaysItBootsIsResetAndNotOffBeforeItHasBooted) {
  DriveRig rig = deafDrive(0.1);
  rig.slave.ignores_nmt = true;
  rig.slave.say(0x700, {0});  // and runs on
  EXPECT_TRUE(isAmong(kResetNode, rig.cycle(DriveGoal::kEnabled)));
  EXPECT_EQ(rig.report().fault, Fault::kDriveStateLost);
  int resets = 0;
  for (int i = 0; i < 300; ++i) {
    resets += isAmong(kResetNode, rig.cycle(DriveGoal::kQuickStop)) ? 1 : 0;
    ASSERT_TRUE(rig.report().is_restarting) << i;
    ASSERT_FALSE(rig.report().is_off) << i;
    ASSERT_FALSE(rig.report().is_silent) << i;
  }
  EXPECT_GE(resets, 1) << "it was heard again, so it had not heard";
  rig.slave.ignores_nmt = false;
  rig.cycles(150, DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.report().is_off);
  EXPECT_FALSE(rig.report().is_restarting);
  EXPECT_EQ(rig.slave.power, ScriptedDrive::kDisabled);
}

TEST(DriveStop, OneThatSaysItBootsTwiceButRunsOnIsResetAgain) {
  DriveRig rig = deafDrive(0.1);
  rig.slave.ignores_nmt = true;
  rig.slave.say(0x700, {0});
  rig.cycle(DriveGoal::kQuickStop);
  rig.slave.say(0x700, {0});
  rig.cycles(2, DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.report().is_restarting) << "one that has booted sends no feedback";
  EXPECT_FALSE(rig.report().is_off);
}

TEST(DriveStop, OneThatIsHeardByItsFeedbackAloneIsResetAgain) {
  DriveRig rig = deafDrive(0.1);
  rig.slave.ignores_nmt = true;
  rig.slave.sends_heartbeat = false;
  rig.slave.say(0x700, {0});  // and runs on
  EXPECT_TRUE(isAmong(kResetNode, rig.cycle(DriveGoal::kQuickStop)));
  int resets = 0;
  for (int i = 0; i < 300; ++i)
    resets += isAmong(kResetNode, rig.cycle(DriveGoal::kQuickStop)) ? 1 : 0;
  EXPECT_GE(resets, 1);
}

TEST(DriveStop, ARealRestartEndsOff) {
  DriveRig rig;
  rig.enable();
  rig.slave.powerUp();
  rig.cycles(10, DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.report().is_off);
  EXPECT_EQ(rig.report().fault, Fault::kDriveStateLost);
  rig.cycles(200, DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.report().is_off);
  EXPECT_FALSE(rig.report().is_silent) << "one that has booted has nothing to say";
}

TEST(DriveStop, OnlyWhatWasSeenOffLosesItsWatchAtTheEnd) {
  DriveRig rig;
  EXPECT_EQ(released(rig), std::vector{kResetNode}) << "never heard of";
  rig.configure();
  rig.cycle(DriveGoal::kDisabled);
  EXPECT_EQ(released(rig), std::vector{kResetCommunication});
  rig.enable();
  EXPECT_EQ(released(rig), std::vector{kResetNode});
  rig.cycles(20, DriveGoal::kQuickStop);
  EXPECT_EQ(released(rig), std::vector{kResetCommunication});
  rig.enable();
  rig.slave.sends_feedback = false;
  rig.cycles(20, DriveGoal::kQuickStop);
  EXPECT_EQ(released(rig), std::vector{kNmtStop}) << "out of reach, and it may still slow down";
  rig.cycles(kDeadlineCycles + 1, DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.report().is_cut_off);
  EXPECT_EQ(released(rig), std::vector{kResetNode});
}

/// What it says is of before its last commands.
TEST(DriveStop, OneThatIsToldToSwitchOnIsNotOffYet) {
  DriveRig rig;
  rig.configure();
  rig.cycle(DriveGoal::kDisabled);
  for (int cycle = 0; cycle < 4; ++cycle) {
    rig.cycle(DriveGoal::kEnabled);
    EXPECT_EQ(released(rig), std::vector{kResetNode});
  }
}

TEST(DriveStop, FeedbackIsJudgedInTheCycleInWhichItComes) {
  DriveRig rig;
  rig.enable();
  rig.slave.say(0x180, {0x18, 0x16, 0, 0, 0, 0});
  for (const CanFrame& frame : rig.slave.take()) rig.drive.receive(frame);
  rig.drive.observe({rig.position, rig.position});
  EXPECT_EQ(rig.report().fault, Fault::kDriveFault) << "before anything is sent";
}

/// Buses that are told nothing are told nothing of a restart either; it is made up for afterwards.
TEST(DriveStop, OneThatHasToRestartIsNotToldInSilence) {
  DriveRig rig = deafDrive(0.1);
  rig.slave.ignores_nmt = true;
  rig.slave.say(0x700, {0});
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(rig.cycle(DriveGoal::kSilent).empty()) << i;
  EXPECT_TRUE(rig.report().is_restarting);
  EXPECT_TRUE(isAmong(kResetNode, rig.cycle(DriveGoal::kQuickStop)));
}

/// A frame may be lost: one that is cut off is told so several times before its bus falls silent.
TEST(DriveStop, OneThatIsCutOffIsToldAgainAndAgain) {
  DriveRig rig;
  rig.enable();
  rig.slave.ignores_commands = rig.slave.ignores_nmt = true;
  rig.cycles(kDeadlineCycles, DriveGoal::kQuickStop);
  int told = 0, cycles_between = 0, longest = 0;
  while (!rig.drive.needsSilence()) {
    const bool is_told = isAmong(kNmtStop, rig.cycle(DriveGoal::kQuickStop));
    told += is_told ? 1 : 0;
    cycles_between = is_told ? 0 : cycles_between + 1;
    longest = std::max(longest, cycles_between);
  }
  EXPECT_GE(told, 4);
  EXPECT_LT(longest, 5);
}

/// Short gaps do not begin its windows anew: one that hides in them would never be seen.
TEST(DriveStop, OneThatMovesOnIsSeenAlsoWhereItsFeedbackHasGaps) {
  DriveRig rig = deafDrive(0.3);
  int cycles = 0;
  for (; !rig.report().is_moving_on && cycles < kDeadlineCycles; ++cycles) {
    rig.slave.sends_feedback = cycles % 15 >= Drive::kMaxSilentCycles;
    rig.cycle(DriveGoal::kQuickStop);
    ASSERT_FALSE(rig.report().is_silent);
  }
  EXPECT_LE(cycles, 300);
}

/// Who repeats its feedback makes time pass faster by no more than a late frame does.
TEST(DriveStop, OneThatMovesOnIsSeenAlsoWhereItsFeedbackIsRepeated) {
  DriveRig rig = deafDrive(0.06);
  int cycles = 0;
  for (; !rig.report().is_moving_on && cycles < kDeadlineCycles; ++cycles) {
    for (const CanFrame& frame : rig.slave.take())
      for (int i = 0; i < 4; ++i) rig.drive.receive(frame);
    rig.cycle(DriveGoal::kQuickStop);
  }
  EXPECT_LE(cycles, 110);
}

TEST(DriveStop, ItsDeadlinePassesInMissedCyclesToo) {
  DriveRig rig;
  rig.enable();
  rig.slave.ignores_commands = rig.slave.ignores_nmt = true;
  rig.cycles(100, DriveGoal::kQuickStop);
  rig.drive.coast(300);
  rig.cycles(kDeadlineCycles - 400, DriveGoal::kQuickStop);
  EXPECT_FALSE(rig.report().is_cut_off);
  rig.cycle(DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.report().is_cut_off);
}

/// As CiA 402 defines its states: without power are those in which no torque can be made.
TEST(DriveStop, OneIsOffInTheStatesWithoutPower) {
  const std::pair<int, bool> states[] = {{0x00, true},  {0x40, true},  {0x21, true},
                                         {0x23, false}, {0x27, false}, {0x07, false},
                                         {0x0F, false}, {0x08, true},  {0x7F, false}};
  for (const auto& [status, is_off] : states) {
    DriveRig rig;
    rig.configure();
    rig.slave.take();
    rig.slave.say(0x180, {status, 0x16, 0, 0, 0, 0});
    rig.cycle(DriveGoal::kDisabled);
    EXPECT_EQ(rig.report().is_off, is_off) << status;
    EXPECT_EQ(rig.report().has_state, status != 0x7F) << status;
  }
}

}  // namespace
}  // namespace tactus
