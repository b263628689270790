#include "tactus/canopen/moteus_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "support/moteus_rig.h"
#include "support/period.h"
#include "tactus/canopen/rest_watch.h"

namespace tactus {
namespace {

using test::kMoteusNode;
using test::moteusConfig;
using test::moteusReply;
using test::MoteusRig;
using test::Said;

TEST(MoteusDrive, TurnsRadiansIntoTurnsAndBack) {
  MoteusRig rig;
  rig.turns = 0.5F;
  rig.enable();
  EXPECT_DOUBLE_EQ(rig.drive.report().position, 0.25 - 1.0);
  rig.turns = 0.0F;
  MoteusRig other;
  other.enable();
  EXPECT_FLOAT_EQ(other.cycle(DriveGoal::kEnabled, 1.5).velocity, -0.75F);
  EXPECT_FLOAT_EQ(other.cycle(DriveGoal::kEnabled, 9.0).velocity, -1.0F) << "at most 2 rad/s";
}

TEST(MoteusDrive, IsNotSilentWhereGapsAreShort) {
  MoteusRig rig;
  rig.enable();
  for (int gap = 0; gap < 20; ++gap) {
    rig.cycle(DriveGoal::kEnabled);
    for (int i = 0; i < MoteusDrive::kMaxSilentCycles; ++i) rig.quietCycle(DriveGoal::kEnabled);
  }
  EXPECT_EQ(rig.drive.report().fault, Fault::kNone);
}

TEST(MoteusDrive, RestsBeforeItLetsGo) {
  MoteusRig rig;
  rig.enable();
  rig.drive.receive(moteusReply(10, 0.0F, 0.3F, 0));
  EXPECT_EQ(rig.quietCycle(DriveGoal::kQuickStop).mode, 12);
  for (int i = 0; i < 3; ++i) {
    rig.drive.receive(moteusReply(12, 0.0F, 0.2F, 0));
    EXPECT_EQ(rig.quietCycle(DriveGoal::kQuickStop).mode, 12);
  }
  rig.mode = 12;
  int cycles = 0;
  while (rig.cycle(DriveGoal::kQuickStop).mode == 12 && cycles < 20) ++cycles;
  EXPECT_LT(cycles, 10);
  rig.mode = 0;
  EXPECT_EQ(rig.cycle(DriveGoal::kQuickStop).mode, 0);
  EXPECT_TRUE(rig.drive.report().is_off);
}

/// A controller's velocity is as noisy as its encoder, also at rest: one that stands has to be let
/// go, and one that creeps is not for the same noise.
TEST(MoteusDrive, RestsByItsPositionWhereItsVelocityIsNoisy) {
  for (const float creep_turns_per_s : {0.0F, 0.025F}) {  // 0.05 rad/s
    MoteusRig rig;
    rig.enable();
    rig.mode = 12;
    bool was_stopped = false;
    for (int i = 0; i < 600; ++i) {
      rig.turns += 0.001F * creep_turns_per_s;
      const float noise = i % 2 == 0 ? 0.05F : -0.05F;
      rig.drive.receive(moteusReply(rig.mode, rig.turns, creep_turns_per_s + noise, 0));
      was_stopped |= rig.quietCycle(DriveGoal::kDisabled).mode == 0;
    }
    EXPECT_EQ(was_stopped, creep_turns_per_s == 0.0F) << creep_turns_per_s;
  }
}

/// Each reply is of one period, so that a window is as long as it should be.
TEST(MoteusDrive, ThatMovesOnInAQuickStopIsSeen) {
  for (const double share : {0.8, 1.4}) {  // of what is taken for rest
    MoteusRig rig;
    rig.enable();
    const double way = share * RestWatch::kMoved * test::kPeriod_s / RestWatch::kWindow_s;
    for (int i = 0; i < 150; ++i) {
      rig.turns += static_cast<float>(0.5 * way);
      rig.cycle(DriveGoal::kQuickStop);
    }
    EXPECT_EQ(rig.drive.report().is_moving_on, share > 1.0);
  }
}

/// Enabled is who was seen enabled in three cycles in a row: what came before counts for nothing.
TEST(MoteusDrive, IsLostOnceItHasSettled) {
  for (int running = 0; running < 6; ++running) {
    MoteusRig rig;
    rig.configure();
    for (int i = 0; i < 3; ++i) rig.cycle(DriveGoal::kEnabled);
    rig.mode = 10;
    for (int i = 0; i < running; ++i) rig.cycle(DriveGoal::kEnabled);
    rig.mode = 0;
    rig.cycle(DriveGoal::kEnabled);
    const Fault expected = running < 3 ? Fault::kNone : Fault::kDriveStateLost;
    EXPECT_EQ(rig.drive.report().fault, expected) << running;
  }
}

/// That it stood still before it moved does not count.
TEST(MoteusDrive, IsNotAtRestAtOnceAfterItHasBegunToMove) {
  MoteusRig rig;
  rig.enable();
  for (int i = 0; i < 300; ++i) rig.cycle(DriveGoal::kEnabled);
  rig.drive.receive(moteusReply(10, 0.0F, 0.3F, 0));
  rig.quietCycle(DriveGoal::kEnabled, 0.6);
  for (int i = 0; i < 100; ++i) {
    rig.drive.receive(moteusReply(12, 0.0F, 0.2F, 0));
    ASSERT_EQ(rig.quietCycle(DriveGoal::kQuickStop).mode, 12) << i;
  }
}

TEST(MoteusDrive, LeavesAFaultAsItIsUntilARestart) {
  MoteusRig rig;
  rig.enable();
  rig.mode = 1;
  rig.fault = 34;
  for (const DriveGoal goal : {DriveGoal::kEnabled, DriveGoal::kQuickStop, DriveGoal::kDisabled})
    EXPECT_EQ(rig.cycle(goal, 1.0).mode, -1) << "which would clear it";
  EXPECT_EQ(rig.drive.report().fault, Fault::kDriveFault);
  EXPECT_EQ(rig.drive.report().emergency_code, 34);
  EXPECT_EQ(rig.cycle(DriveGoal::kConfigure, 0.0, true).mode, -1) << "first it is asked";
  EXPECT_EQ(rig.cycle(DriveGoal::kConfigure).mode, 0);
}

TEST(MoteusDrive, NeedsItsWatchdog) {
  CanopenConfig canopen;
  for (const double timeout_s : {0.0, -1.0, std::nan("")}) {
    canopen.heartbeat_timeout_s = timeout_s;
    EXPECT_THROW(MoteusDrive(moteusConfig(), canopen, test::kPeriod_s), std::invalid_argument);
  }
}

TEST(MoteusDrive, CountsRepliesThatAreNone) {
  MoteusRig rig;
  CanFrame frame = moteusReply(10, 0.0F, 0.0F, 0);
  frame.size = 5;
  rig.drive.receive(frame);
  EXPECT_EQ(rig.drive.malformedFrames(), 1u);
  frame.id = moteusReplyId(kMoteusNode + 1);
  rig.drive.receive(frame);
  EXPECT_EQ(rig.drive.malformedFrames(), 1u) << "another node's";
  MoteusRig running;
  running.enable();
  frame.id = moteusReplyId(kMoteusNode);
  for (int i = 0; i < 20; ++i) {
    running.drive.receive(moteusReply(10, 0.0F, 0.0F, 0));
    running.drive.receive(frame);
    running.quietCycle(DriveGoal::kEnabled);
  }
  EXPECT_EQ(running.drive.report().fault, Fault::kNone) << "good replies count beside them";
}

/// Each by itself; the position stays the last good one.
TEST(MoteusDrive, APositionOrVelocityThatIsNoNumberIsAFault) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (const bool is_velocity : {false, true}) {
    MoteusRig rig;
    rig.enable();
    const double position = rig.drive.report().position;
    rig.drive.receive(moteusReply(10, is_velocity ? 0.3F : kNaN, is_velocity ? kNaN : 0.0F, 0));
    rig.quietCycle(DriveGoal::kEnabled);
    EXPECT_EQ(rig.drive.report().fault, Fault::kDriveFault);
    EXPECT_EQ(rig.drive.report().position, position);
  }
}

TEST(MoteusDrive, IsSetUpAtFirstWithoutBeingRestarted) {
  MoteusRig rig;
  rig.cycle(DriveGoal::kConfigure);
  rig.cycle(DriveGoal::kConfigure);
  EXPECT_TRUE(rig.drive.report().is_configured);
}

TEST(MoteusDrive, APlaceThatIsNoNumberIsNoCommand) {
  MoteusRig rig;
  rig.enable();
  rig.drive.coast(1000);
  rig.cycle(DriveGoal::kEnabled, 0.1);
  EXPECT_EQ(rig.drive.report().fault, Fault::kNone)
      << "cycles that were missed are no fault of its";
  rig.position = std::nan("");
  EXPECT_NE(rig.cycle(DriveGoal::kEnabled, 0.1).mode, 10);
  EXPECT_EQ(rig.drive.report().fault, Fault::kCommandNotFinite);
}

/// Told to by the user, it is set up again without a start of its own.
TEST(MoteusDrive, IsSetUpAnewOnRestart) {
  MoteusRig rig;
  rig.enable();
  rig.mode = 0;
  rig.cycle(DriveGoal::kConfigure);
  EXPECT_TRUE(rig.drive.report().is_configured) << "nobody asked for it";
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  EXPECT_FALSE(rig.drive.report().is_configured);
  rig.cycle(DriveGoal::kConfigure);
  EXPECT_TRUE(rig.drive.report().is_configured);
}

/// At rest is a joint, not a shaft: 0.01 rad/s are 0.005 turns/s of this one.
TEST(MoteusDrive, IsStoppedWhenItsJointRests) {
  for (const float turns_per_s : {0.0048F, 0.0052F}) {
    MoteusRig rig;
    rig.enable();
    Said said;
    for (int i = 0; i < 30; ++i) {
      rig.drive.receive(moteusReply(10, 0.0F, i < 10 ? 0.1F : turns_per_s, 0));
      said = rig.quietCycle(DriveGoal::kDisabled);
      EXPECT_TRUE(i >= 10 || said.mode == 12) << "zero velocity, while it moves";
    }
    EXPECT_EQ(said.mode, turns_per_s < 0.005F ? 0 : 12);
  }
}

TEST(MoteusDrive, IsNotSilentWhileNobodyAsks) {
  MoteusRig rig;
  rig.configure();
  for (int i = 0; i < 50; ++i) EXPECT_EQ(rig.quietCycle(DriveGoal::kSilent).mode, -2);
  EXPECT_EQ(rig.drive.report().fault, Fault::kNone);
  for (int i = 0; i < MoteusDrive::kMaxSilentCycles; ++i) rig.quietCycle(DriveGoal::kDisabled);
  EXPECT_EQ(rig.drive.report().fault, Fault::kNone);
  rig.quietCycle(DriveGoal::kDisabled);
  EXPECT_EQ(rig.drive.report().fault, Fault::kDriveSilent);
  EXPECT_STREQ(rig.drive.report().detail.unit, "cycles without reply");
}

TEST(MoteusDrive, ARequestThatIsNoNumberIsNone) {
  for (const double velocity : {std::nan(""), HUGE_VAL}) {
    MoteusRig rig;
    rig.enable();
    EXPECT_EQ(rig.cycle(DriveGoal::kEnabled, velocity).mode, 0) << "it rests already";
    EXPECT_EQ(rig.drive.report().fault, Fault::kCommandNotFinite);
  }
}

/// Whatever it replies and whatever is wanted of it: no velocity but the one that was asked for,
/// and none unless it follows, is set up and has no fault.
TEST(MoteusDrive, GetsNoOtherVelocity) {
  std::mt19937 random(17);
  const auto chance = [&random](int one_in) {
    return random() % static_cast<unsigned>(one_in) == 0;
  };
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  int moved = 0;
  for (int run = 0; run < 200; ++run) {
    MoteusRig rig;
    rig.enable();
    DriveGoal goal = DriveGoal::kEnabled;
    for (int cycle = 0; cycle < 200; ++cycle) {
      if (chance(60)) goal = static_cast<DriveGoal>(random() % 5);
      const int mode = chance(40) ? static_cast<int>(random() % 17) : 10;
      const float turns = chance(200) ? kNaN : 0.001F * static_cast<float>(random() % 10);
      if (!chance(10)) rig.drive.receive(moteusReply(mode, turns, 0.0F, chance(50) ? 33 : 0));
      const double velocity = 0.01 * static_cast<double>(random() % 100);
      const Said said = rig.quietCycle(goal, velocity, chance(50));
      const DriveReport& report = rig.drive.report();
      const bool is_quiet = goal == DriveGoal::kSilent || report.is_cut_off;
      EXPECT_TRUE(!is_quiet || said.mode == -2) << said.mode;
      EXPECT_TRUE(goal == DriveGoal::kEnabled || said.mode != 10);
      ASSERT_TRUE(std::isfinite(said.velocity) && std::isfinite(report.position));
      if (said.velocity == 0.0F) continue;
      ++moved;
      EXPECT_FLOAT_EQ(said.velocity, static_cast<float>(-0.5 * velocity));
      EXPECT_EQ(report.state, DriveState::kOperationEnabled);
      EXPECT_EQ(report.fault, Fault::kNone);
      EXPECT_TRUE(report.is_configured);
    }
  }
  EXPECT_GT(moved, 500);
}

}  // namespace
}  // namespace tactus
