#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

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
    EXPECT_FALSE(running.report().is_silent);
    running.until([&] { return running.report().fault != Fault::kNone; }, DriveGoal::kEnabled);
    expectTold(running, lacks_feedback ? Drive::kMaxSilentCycles : heartbeat_cycles);
    EXPECT_EQ(running.report().is_silent, lacks_feedback) << "else its state is no old one";
    running.slave.sends_feedback = running.slave.sends_heartbeat = true;
    running.cycles(30, DriveGoal::kQuickStop);
    EXPECT_FALSE(running.report().is_silent) << "it is heard again, whatever its fault";
  }
}

/// As by a tool that scans the bus: a drive that goes on then, whatever PDOs say.
TEST(DriveTimes, ADriveThatLeavesOperationalGetsNmtStopAtOnce) {
  test::DriveRig rig;
  rig.enable();
  rig.cycles(20, DriveGoal::kEnabled, 0.5);
  rig.slave.nmt = 127;
  const CanFrame stop = test::rawFrame(0, {2, test::kNode});
  int cycles = 0, stops = 0;
  for (; cycles < 300 && rig.slave.power == test::ScriptedDrive::kEnabled; ++cycles) {
    const DriveGoal goal =
        rig.report().fault == Fault::kNone ? DriveGoal::kEnabled : DriveGoal::kQuickStop;
    const std::vector<CanFrame> sent = rig.cycle(goal, 0.5);
    stops += std::ranges::find(sent, stop) != sent.end();
  }
  EXPECT_GT(stops, 0);
  EXPECT_NE(rig.report().fault, Fault::kNone);
  EXPECT_LT(cycles, 40) << "its next heartbeat, and what is missing of its feedback";
}

/// Its feedback says otherwise.
TEST(DriveTimes, OneHeartbeatThatSaysSoIsNotBelieved) {
  test::DriveRig rig;
  rig.enable();
  rig.slave.say(0x700, {127});
  for (int i = 0; i < 50; ++i)
    for (const CanFrame& frame : rig.cycle(DriveGoal::kQuickStop)) EXPECT_NE(frame.id, 0u);
}

bool isStarted(const std::vector<CanFrame>& frames) {
  return std::find(frames.begin(), frames.end(), test::rawFrame(0, {1, test::kNode})) !=
         frames.end();
}

/// From NMT start on, it has the time of a heartbeat and of an answer to run.
TEST(DriveTimes, AStartHasItsTimeAndNoMore) {
  test::DriveRig rig;
  rig.slave.sends_feedback = rig.slave.sends_heartbeat = false;
  bool is_started = isStarted(rig.cycle(DriveGoal::kConfigure, 0.0, true));
  for (int i = 0; i < 200 && !is_started; ++i)
    is_started = isStarted(rig.cycle(DriveGoal::kConfigure));
  ASSERT_TRUE(is_started);
  const int cycles =
      rig.until([&] { return rig.report().fault != Fault::kNone; }, DriveGoal::kConfigure);
  const CanopenConfig canopen;
  EXPECT_EQ(
      cycles,
      std::round((canopen.heartbeat_timeout_s + canopen.sdo_timeout_s) / test::kPeriod_s) + 1);
}

/// That it was silent before its set-up is no part of a gap after it.
TEST(DriveTimes, SilenceOfBeforeItsSetUpDoesNotCount) {
  test::DriveRig rig;
  rig.enable();
  rig.slave.sends_feedback = false;
  rig.cycles(200, DriveGoal::kQuickStop);
  ASSERT_EQ(rig.report().fault, Fault::kDriveSilent);
  rig.slave.sends_feedback = true;
  rig.configure();
  rig.slave.take();
  rig.slave.sends_feedback = false;
  rig.cycles(Drive::kMaxSilentCycles, DriveGoal::kDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  rig.cycle(DriveGoal::kDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kDriveSilent);
}

/// Once it is heard again, that it moves on in a quick stop is seen before it is known to run.
TEST(DriveTimes, SilenceOfBeforeItsSetUpHidesNoMotion) {
  test::DriveRig rig;
  rig.enable();
  rig.slave.sends_feedback = false;
  rig.cycles(200, DriveGoal::kQuickStop);
  rig.slave.sends_feedback = true;
  rig.slave.sends_heartbeat = false;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.until([&] { return rig.report().has_position; }, DriveGoal::kConfigure);
  for (int i = 0; i < 110; ++i) {
    rig.slave.position += 100;  // 0.5 rad/s
    rig.cycle(DriveGoal::kQuickStop);
  }
  EXPECT_FALSE(rig.report().is_configured);
  EXPECT_TRUE(rig.report().is_moving_on);
}

/// An answer is waited for, in which its value may change; the time of each is its own.
TEST(DriveTimes, AValueIsWaitedForAsLongAsAnAnswer) {
  test::DriveRig rig;
  rig.slave.shows_mode = false;
  const auto isAsked = [](const std::vector<CanFrame>& frames) {
    return std::any_of(frames.begin(), frames.end(), [](const CanFrame& frame) {
      return frame.id == 0x600u + test::kNode && frame.data[0] == 0x40 && frame.data[1] == 0x61;
    });
  };
  bool is_asked = isAsked(rig.cycle(DriveGoal::kConfigure, 0.0, true));
  for (int i = 0; i < 200 && !is_asked; ++i) is_asked = isAsked(rig.cycle(DriveGoal::kConfigure));
  ASSERT_TRUE(is_asked);
  const int cycles =
      rig.until([&] { return rig.report().fault != Fault::kNone; }, DriveGoal::kConfigure);
  EXPECT_EQ(cycles, std::round(CanopenConfig{}.sdo_timeout_s / test::kPeriod_s));
  EXPECT_EQ(rig.report().setup_failure.index, 0x6061);
}

/// One that boots so late is refused: nothing more is asked of it.
TEST(DriveTimes, NothingIsAskedBehindTheTimeOfABoot) {
  for (int most = 90; most < 220; ++most) {
    CanopenConfig canopen;
    canopen.boot_timeout_s = most * test::kPeriod_s;
    DriveSetup setup(test::driveConfig(), canopen, test::kPeriod_s);
    setup.start();
    int last_asked = 0;
    for (int cycle = 1; cycle < 500; ++cycle) {
      FrameBatch out;
      setup.update(out);
      if (!out.empty() && out.begin()->id == 0) last_asked = cycle;
    }
    EXPECT_EQ(setup.status(), DriveSetup::Status::kFailed);
    EXPECT_LE(last_asked, most);
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
