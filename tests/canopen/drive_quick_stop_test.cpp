#include <gtest/gtest.h>

#include <vector>

#include "support/drive_rig.h"

/// Drives whose quick stop does not end in switch on disabled by itself.
namespace tactus {
namespace {

using test::commandOf;
using test::DriveRig;
using test::ScriptedDrive;

/// By quick stop option codes 5 to 8, which robot.yaml's `without` leaves to the drive.
TEST(DriveQuickStop, OneThatStaysInQuickStopIsLedThroughSwitchOnDisabledWhenItIsAskedForAgain) {
  DriveRig rig;
  rig.slave.stays_in_quick_stop = true;
  rig.enable();
  for (const DriveGoal goal : {DriveGoal::kQuickStop, DriveGoal::kDisabled, DriveGoal::kQuickStop})
    for (int i = 0; i < 300; ++i) EXPECT_NE(commandOf(rig.cycle(goal)).control_word, 0) << i;
  ASSERT_EQ(rig.report().state, DriveState::kQuickStopActive);
  rig.position = rig.report().position;
  std::vector<int> words;
  for (int i = 0; i < 300; ++i) {
    const int word = commandOf(rig.cycle(DriveGoal::kEnabled)).control_word;
    if (words.empty() || words.back() != word) words.push_back(word);
  }
  EXPECT_EQ(words, (std::vector{0x00, 0x06, 0x07, 0x0F}));
  EXPECT_EQ(rig.report().state, DriveState::kOperationEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone) << faultName(rig.report().fault);
}

/// One that rests there when it is set up, as a master before has left it, is off as all others
/// are.
TEST(DriveQuickStop, OneThatIsFoundInQuickStopIsLedOutOfItByTheSetUp) {
  DriveRig rig;
  rig.slave.stays_in_quick_stop = true;
  rig.enable();
  rig.cycles(300, DriveGoal::kQuickStop);
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
  ASSERT_EQ(rig.report().state, DriveState::kQuickStopActive);
  rig.cycles(300, DriveGoal::kConfigure);
  EXPECT_EQ(rig.report().state, DriveState::kSwitchOnDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone) << faultName(rig.report().fault);
}

/// Without voltage it would coast.
TEST(DriveQuickStop, OneThatStillSlowsDownInQuickStopKeepsItsVoltage) {
  DriveRig rig;
  rig.slave.stays_in_quick_stop = true;
  rig.enable();
  rig.cycles(10, DriveGoal::kQuickStop);
  int cycles = 0;
  for (; commandOf(rig.cycle(DriveGoal::kEnabled)).control_word != 0 && cycles < 1000; ++cycles)
    if (cycles < 300) rig.slave.position += 100;  // 0.5 rad/s
  EXPECT_GE(cycles, 300 + 195);
  EXPECT_LE(cycles, 300 + 210);
}

/// One that left operation unasked gets no second chance by it.
TEST(DriveQuickStop, OneThatWentToQuickStopByItselfIsLeftThere) {
  DriveRig rig;
  rig.slave.stays_in_quick_stop = true;
  rig.enable();
  rig.slave.power = ScriptedDrive::kQuickStop;
  for (int i = 0; i < 500; ++i)
    EXPECT_NE(commandOf(rig.cycle(DriveGoal::kEnabled)).control_word, 0) << i;
  EXPECT_EQ(rig.report().fault, Fault::kDriveStateLost);
}

}  // namespace
}  // namespace tactus
