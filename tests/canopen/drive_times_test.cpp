#include <gtest/gtest.h>

#include <cmath>

#include "support/drive_rig.h"
#include "tactus/canopen/drive_setup.h"

/// For how long a drive is waited for, to the cycle.
namespace tactus {
namespace {

/// One that boots too late is refused, however soon it would have answered, and however far it had
/// come: what it lacks is an answer to the first question, and it refused nothing.
TEST(DriveTimes, ABootHasItsTimeAndNoMore) {
  CanopenConfig canopen;
  canopen.boot_timeout_s = 0.02;
  for (const int cycles : {19, 20}) {
    DriveSetup setup(test::driveConfig(), canopen, test::kPeriod_s);
    for (int start = 0; start < 2; ++start) {  // each has all of it
      setup.start();
      for (int i = 0; i < cycles; ++i) {
        FrameBatch out;
        setup.update(out);
        if (start == 1 && i == 5)
          setup.receive(test::rawFrame(0x580 + test::kNode,
                                       {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00}));
      }
      setup.onBootUp();
      const bool is_late = cycles == 20;
      EXPECT_EQ(setup.status(), is_late ? DriveSetup::Status::kFailed : DriveSetup::Status::kBusy);
      EXPECT_EQ(setup.failure().index, is_late ? 0x1000 : 0);
      EXPECT_EQ(setup.failure().subindex, 0);
      EXPECT_EQ(setup.failure().abort_code, 0u);
      EXPECT_FALSE(setup.failure().is_other_value);
    }
  }
}

TEST(DriveTimes, HeardWithinTheHeartbeatTimeoutIsNotSilent) {
  test::DriveRig rig;
  rig.enable();
  rig.slave.sends_heartbeat = false;
  rig.slave.say(0x700, {5});  // in the first of these cycles
  rig.cycles(60, DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  rig.cycle(DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kDriveSilent);
}

/// What is told of a silent drive is the first cycle beyond its limit, in each phase of its life.
TEST(DriveTimes, SilenceIsToldInTheFirstCycleBeyondItsLimit) {
  const CanopenConfig canopen;
  const double heartbeat_cycles = std::round(canopen.heartbeat_timeout_s / test::kPeriod_s);
  const double answer_cycles = std::round(canopen.sdo_timeout_s / test::kPeriod_s);
  const auto expectTold = [](const test::DriveRig& rig, double limit) {
    EXPECT_EQ(rig.report().fault, Fault::kDriveSilent);
    EXPECT_EQ(rig.report().detail.limit, limit) << rig.report().detail.unit;
    EXPECT_EQ(rig.report().detail.value, limit + 1.0) << rig.report().detail.unit;
  };
  test::DriveRig starting;
  starting.slave.sends_feedback = starting.slave.sends_heartbeat = false;
  starting.configure();
  expectTold(starting, heartbeat_cycles + answer_cycles);
  for (const bool lacks_feedback : {false, true}) {
    test::DriveRig running;
    running.enable();
    (lacks_feedback ? running.slave.sends_feedback : running.slave.sends_heartbeat) = false;
    running.until([&] { return running.report().fault != Fault::kNone; }, DriveGoal::kEnabled);
    expectTold(running, lacks_feedback ? Drive::kMaxSilentCycles : heartbeat_cycles);
  }
}

/// It is given as long as an answer may take to leave a fault of before, from when it is enabled.
TEST(DriveTimes, AnOldFaultHasTheTimeOfAnAnswerToBeReset) {
  test::DriveRig rig;
  rig.slave.power = test::ScriptedDrive::kFault;
  rig.slave.resets_refused = 1000000;
  rig.configure();
  rig.cycles(300, DriveGoal::kDisabled);
  ASSERT_EQ(rig.report().fault, Fault::kNone);
  const int cycles =
      rig.until([&] { return rig.report().fault != Fault::kNone; }, DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kDriveFault);
  EXPECT_TRUE(std::isnan(rig.report().detail.value)) << "no EMCY has named a reason";
  // Seen in the cycle after that which first asks.
  EXPECT_EQ(cycles, std::round(CanopenConfig{}.sdo_timeout_s / test::kPeriod_s) + 2);
}

}  // namespace
}  // namespace tactus
