#include <gtest/gtest.h>

#include "support/drive_rig.h"
#include "tactus/canopen/drive_setup.h"

/// For how long a drive is waited for, to the cycle.
namespace tactus {
namespace {

/// One that boots too late is refused, however soon it would have answered.
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
      }
      setup.onBootUp();
      EXPECT_EQ(setup.status(),
                cycles < 20 ? DriveSetup::Status::kBusy : DriveSetup::Status::kFailed);
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

}  // namespace
}  // namespace tactus
