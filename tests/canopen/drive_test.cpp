#include "tactus/canopen/drive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/drive_rig.h"
#include "support/random.h"

/// A drive that does what it should.
namespace tactus {
namespace {

using test::commandOf;
using test::DriveRig;
using test::kNode;
using test::ScriptedDrive;

TEST(Drive, ReportsWhereItIs) {
  DriveRig rig;
  rig.slave.position = -30000;  // of 2e5 a unit, turning the other way round, 0 at 0.25
  rig.configure();
  EXPECT_TRUE(rig.report().has_position);
  EXPECT_DOUBLE_EQ(rig.report().position, 0.25 + 0.15);
  EXPECT_EQ(rig.report().state, DriveState::kSwitchOnDisabled);
}

TEST(Drive, IsEnabledStepByStepAndDisabledAgain) {
  DriveRig rig;
  rig.configure();
  std::vector<int> words;
  for (int cycle = 0; cycle < 20; ++cycle) {
    const DriveCommand command = commandOf(rig.cycle(DriveGoal::kEnabled));
    if (words.empty() || words.back() != command.control_word)
      words.push_back(command.control_word);
  }
  EXPECT_EQ(words, (std::vector{0x06, 0x07, 0x0F}));
  EXPECT_EQ(rig.slave.power, ScriptedDrive::kEnabled);
  words.clear();
  for (int cycle = 0; cycle < 20; ++cycle) {
    const DriveCommand command = commandOf(rig.cycle(DriveGoal::kDisabled));
    if (words.empty() || words.back() != command.control_word)
      words.push_back(command.control_word);
  }
  EXPECT_EQ(words, (std::vector{0x07, 0x02, 0x00}));
  EXPECT_EQ(rig.slave.power, ScriptedDrive::kDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

TEST(Drive, FollowsTheVelocityWithSignAndScale) {
  DriveRig rig;
  rig.enable();
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, 0.1)),
            (DriveCommand{0x0F, -20000}));  // -0.1 * 2e5
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, -0.25)), (DriveCommand{0x0F, 50000}));
  const double before = rig.position;
  rig.cycles(1000, DriveGoal::kEnabled, 0.1);
  rig.cycles(3, DriveGoal::kEnabled, 0.0);
  EXPECT_NEAR(rig.position, before + 0.1, 1e-9);
  EXPECT_NEAR(rig.report().position, rig.position, 2.0 / 2e5);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

TEST(Drive, DoesNotStrayAtVelocitiesBelowACount) {
  DriveRig rig;
  rig.enable();
  long sum = 0;
  for (int cycle = 0; cycle < 20000; ++cycle)
    sum += commandOf(rig.cycle(DriveGoal::kEnabled, 1.7e-6)).velocity;  // -0.34 counts/s
  EXPECT_NEAR(static_cast<double>(sum), -6800.0, 1.0);
}

TEST(Drive, ForgetsTheRestOfAnEarlierMotion) {
  DriveRig rig;
  rig.enable();
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, 2e-6)).velocity, 0);  // -0.4 counts/s
  rig.cycles(10, DriveGoal::kDisabled);
  rig.cycles(10, DriveGoal::kEnabled);
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, 2e-6)).velocity, 0);
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, 2e-6)).velocity, -1);
}

TEST(Drive, IsPulledToTheCommandedPosition) {
  DriveConfig config = test::driveConfig();
  config.tracking_gain_per_s = 20.0;
  DriveRig rig(config);
  rig.enable();
  rig.position += 0.01;
  EXPECT_NEAR(commandOf(rig.cycle(DriveGoal::kEnabled)).velocity, -20.0 * 0.01 * 2e5, 1.0);
  rig.cycles(1000, DriveGoal::kEnabled);
  EXPECT_NEAR(rig.report().position, rig.position, 2.0 / 2e5);
  rig.position += 0.01;
  rig.slave.sends_feedback = false;
  rig.cycle(DriveGoal::kEnabled);
  rig.position += 1.0;  // no new feedback to judge by: the pull is bounded all the same
  EXPECT_NEAR(commandOf(rig.cycle(DriveGoal::kEnabled)).velocity, -20.0 * 0.05 * 2e5, 1.0);
}

TEST(Drive, IsNotPulledFasterThanItsJointMayMove) {
  DriveConfig config = test::driveConfig();
  config.tracking_gain_per_s = 100.0;
  config.max_velocity = 0.5;
  DriveRig rig(config);
  rig.enable();
  rig.position += 0.04;
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled)).velocity, -100000);  // 0.5 * 2e5
  rig.position = rig.report().position - 0.04;
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, -2.0)).velocity, 100000);
}

TEST(Drive, SendsOneSetpointACycleAndNothingElseWhileConfigured) {
  DriveRig rig;
  rig.enable();
  for (DriveGoal goal : {DriveGoal::kEnabled, DriveGoal::kDisabled, DriveGoal::kConfigure,
                         DriveGoal::kEnabled, DriveGoal::kQuickStop}) {
    for (int cycle = 0; cycle < 100; ++cycle) {
      const auto frames = rig.cycle(goal, 0.0);
      ASSERT_EQ(frames.size(), 1u);
      ASSERT_EQ(frames[0].id, 0x200u + kNode);
      ASSERT_EQ(frames[0].size, 6);
    }
  }
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  EXPECT_TRUE(rig.cycle(DriveGoal::kSilent, 1.0).empty());
}

TEST(Drive, SendsNoVelocityBeforeItIsEnabledNorAfter) {
  DriveRig rig;
  rig.configure();
  for (int cycle = 0; cycle < 30; ++cycle) {
    const bool is_enabled = rig.report().state == DriveState::kOperationEnabled;
    const DriveCommand command = commandOf(rig.cycle(DriveGoal::kEnabled, 0.001));
    if (!is_enabled && rig.report().state != DriveState::kOperationEnabled) {
      EXPECT_EQ(command.velocity, 0);
    }
  }
  EXPECT_NE(rig.slave.velocity, 0);
  for (DriveGoal goal : {DriveGoal::kDisabled, DriveGoal::kConfigure, DriveGoal::kQuickStop}) {
    DriveRig other;
    other.enable();
    for (int cycle = 0; cycle < 30; ++cycle)
      EXPECT_EQ(commandOf(other.cycle(goal, 1.0)).velocity, 0);
  }
}

TEST(Drive, StopsByItselfOnQuickStopAndIsLeftTheTime) {
  DriveRig rig;
  rig.slave.quick_stop_cycles = 50;
  rig.enable();
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kQuickStop, 1.0)), (DriveCommand{0x02, 0}));
  rig.cycles(20, DriveGoal::kQuickStop);
  EXPECT_EQ(rig.slave.power, ScriptedDrive::kQuickStop);
  rig.cycles(20, DriveGoal::kDisabled);
  EXPECT_EQ(rig.slave.power, ScriptedDrive::kQuickStop) << "its ramp was cut short";
  rig.cycles(20, DriveGoal::kDisabled);
  EXPECT_EQ(rig.slave.power, ScriptedDrive::kDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

TEST(Drive, CanBeAskedForAnythingAtAnyTime) {
  test::Random random(405);
  DriveRig rig;
  rig.configure();
  for (int change = 0; change < 2000; ++change) {
    static constexpr DriveGoal kGoals[] = {DriveGoal::kDisabled, DriveGoal::kEnabled,
                                           DriveGoal::kQuickStop, DriveGoal::kConfigure};
    rig.position = rig.report().position;
    rig.cycles(random.integer(1, 8), kGoals[random.index(4)]);
    ASSERT_EQ(rig.report().fault, Fault::kNone) << faultName(rig.report().fault) << change;
  }
}

TEST(Drive, IsNotHarmedByDuplicatedOrLateFeedback) {
  DriveRig rig;
  rig.enable();
  std::vector<CanFrame> last;
  for (int cycle = 0; cycle < 200; ++cycle) {
    const std::vector<CanFrame> now = rig.slave.take();
    for (const CanFrame& frame : last) rig.drive.receive(frame);  // again, before
    for (const CanFrame& frame : now) {
      if (cycle % 4 == 0) continue;  // comes with the next ones
      rig.drive.receive(frame);
      rig.drive.receive(frame);
    }
    last = now;
    rig.cycle(DriveGoal::kEnabled, 0.2);
  }
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  rig.cycles(3, DriveGoal::kEnabled);
  EXPECT_NEAR(rig.report().position, rig.position, 2.0 / 2e5);
}

TEST(Drive, ResetsAnOldFaultOnceOnItsWayToOperation) {
  DriveRig rig;
  rig.slave.power = ScriptedDrive::kFault;
  rig.configure();
  rig.cycles(50, DriveGoal::kDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  EXPECT_EQ(rig.report().state, DriveState::kFault);
  EXPECT_EQ(rig.slave.resets, 0) << "nobody asked for power";
  rig.until([&] { return rig.report().state == DriveState::kOperationEnabled; },
            DriveGoal::kEnabled, 12);
  EXPECT_EQ(rig.slave.resets, 1);
  rig.cycles(10, DriveGoal::kEnabled);
  EXPECT_EQ(rig.slave.control, 0x0F);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

TEST(Drive, ResetsAnOldFaultAfterEveryRestart) {
  DriveRig rig;
  for (int restart = 1; restart <= 60; ++restart) {
    rig.slave.power = ScriptedDrive::kFault;
    rig.enable();
    ASSERT_EQ(rig.slave.resets, restart);
  }
}

TEST(Drive, IsFaultyIfAnOldFaultDoesNotGo) {
  DriveRig rig;
  rig.slave.power = ScriptedDrive::kFault;
  rig.slave.resets_refused = 1000;
  rig.configure();
  rig.cycles(90, DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  const int more =
      rig.until([&] { return rig.report().fault == Fault::kDriveFault; }, DriveGoal::kEnabled, 20);
  EXPECT_EQ(90 + more, 102) << "0.1 s from the cycle after the reset was sent";
  rig.cycles(500, DriveGoal::kEnabled);
  EXPECT_EQ(rig.slave.resets, 1);
}

TEST(Drive, IsFaultyIfTheResetOfAnOldFaultIsBrokenOff) {
  DriveRig rig;
  rig.slave.power = ScriptedDrive::kFault;
  rig.slave.resets_refused = 1000;
  rig.configure();
  rig.cycle(DriveGoal::kEnabled);
  rig.cycles(3, DriveGoal::kDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kDriveFault);
}

TEST(Drive, DoesNotResetAgainAndAgainWhenGoalsChange) {
  DriveRig rig;
  rig.slave.power = ScriptedDrive::kFault;
  rig.slave.resets_refused = 1000;
  rig.configure();
  for (int change = 0; change < 20; ++change) {
    rig.cycles(4, DriveGoal::kEnabled);
    rig.cycles(4, DriveGoal::kDisabled);
  }
  EXPECT_EQ(rig.report().fault, Fault::kDriveFault);
  EXPECT_EQ(rig.slave.resets, 1);
}

TEST(Drive, IsSetUpByItselfWhereNothingWasSaidBefore) {
  DriveRig rig;
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

}  // namespace
}  // namespace tactus
