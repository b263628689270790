#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/moteus_rig.h"

/// How a moteus is brought to rest, and what is held against one that does not obey.
namespace tactus {
namespace {

using test::kMoteusNode;
using test::moteusReply;
using test::MoteusRig;
using test::Said;

constexpr int kMoteusDeadlineCycles = 500;  // CanopenConfig::stop_deadline_s
constexpr int kRestingReplies = 5;

/// Enabled, and moving: its next command to stop finds it so.
MoteusRig movingMoteus() {
  MoteusRig rig;
  rig.enable();
  rig.drive.receive(moteusReply(10, 0.0F, 0.3F, 0));
  rig.quietCycle(DriveGoal::kEnabled, 0.6);
  return rig;
}

TEST(MoteusStop, LetsGoInTheFifthReplyInARowThatSaysItRests) {
  MoteusRig rig = movingMoteus();
  const auto modeAfter = [&rig](float turns_per_s) {
    rig.drive.receive(moteusReply(12, 0.0F, turns_per_s, 0));
    return rig.quietCycle(DriveGoal::kQuickStop).mode;
  };
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(modeAfter(0.3F), 12);
    for (int i = 1; i < kRestingReplies; ++i) EXPECT_EQ(modeAfter(0.0F), 12) << i;
  }
  EXPECT_EQ(modeAfter(0.0F), 0);
}

/// In int16, as no float is just as fast.
TEST(MoteusStop, SlowerThanItsLimitIsRestAndNoVelocityThatIsNot) {
  MoteusRig rig = movingMoteus();
  CanFrame reply;  // in int16, mode and position, then 20 of 0.00025 turns/s, and no fault
  reply.id = moteusReplyId(kMoteusNode);
  reply.is_fd = true;
  reply.data = {0x27, 0x00, 12, 0, 0, 0, 20, 0, 0x21, 0x0F, 0};
  reply.size = 11;
  const auto letsGo = [&] {
    for (int i = 0; i < 20; ++i) {
      rig.drive.receive(reply);
      if (rig.quietCycle(DriveGoal::kQuickStop).mode == 0) return true;
    }
    return false;
  };
  EXPECT_FALSE(letsGo()) << "0.01 rad/s";
  reply.data[6] = 19;
  EXPECT_TRUE(letsGo());
}

TEST(MoteusStop, ReliesOnNoReplyTwice) {
  MoteusRig rig = movingMoteus();
  rig.drive.receive(moteusReply(12, 0.0F, 0.0F, 0));
  for (int i = 0; i < MoteusDrive::kMaxSilentCycles; ++i)
    EXPECT_EQ(rig.quietCycle(DriveGoal::kQuickStop).mode, 12) << i;
}

/// Its rest before a set-up says nothing of what it does at the next.
TEST(MoteusStop, SlowsDownOneThatIsFoundMovingWhereItRestedBefore) {
  MoteusRig rig;
  rig.enable();
  rig.mode = 12;
  for (int i = 0; i < 300; ++i) {
    rig.drive.receive(moteusReply(12, 0.0F, 0.05F, 0));  // noise: it stands
    rig.quietCycle(DriveGoal::kDisabled);
  }
  ASSERT_EQ(rig.quietCycle(DriveGoal::kDisabled).mode, 0);
  rig.quietCycle(DriveGoal::kConfigure, 0.0, true);
  rig.drive.receive(moteusReply(10, 0.0F, 0.3F, 0));
  EXPECT_EQ(rig.quietCycle(DriveGoal::kConfigure).mode, 12);
}

TEST(MoteusStop, OneThatFollowsThoughDisabledIsAFaultBehindTheDeadline) {
  MoteusRig rig;
  rig.enable();
  rig.cycles(2 * kMoteusDeadlineCycles, DriveGoal::kEnabled);
  EXPECT_EQ(rig.drive.report().fault, Fault::kNone) << "it is to follow";
  rig.cycles(kMoteusDeadlineCycles, DriveGoal::kDisabled);
  EXPECT_EQ(rig.drive.report().fault, Fault::kNone);
  rig.cycle(DriveGoal::kDisabled);
  EXPECT_EQ(rig.drive.report().fault, Fault::kDriveStateLost);
}

TEST(MoteusStop, OneThatIsOffMayBeSoForLong) {
  for (const DriveGoal goal : {DriveGoal::kDisabled, DriveGoal::kQuickStop}) {
    MoteusRig rig;
    rig.configure();
    rig.cycles(3 * kMoteusDeadlineCycles, goal);
    EXPECT_EQ(rig.drive.report().fault, Fault::kNone);
    EXPECT_FALSE(rig.drive.report().is_cut_off);
  }
}

/// Nothing is held against one that has yet to be set up: nobody has asked it for anything.
TEST(MoteusStop, OneThatIsNotSetUpIsHeldAgainstNothing) {
  MoteusRig rig;
  rig.mode = 10;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.cycles(2 * kMoteusDeadlineCycles, DriveGoal::kDisabled);
  EXPECT_EQ(rig.drive.report().fault, Fault::kNone);
}

TEST(MoteusStop, ItsDeadlinePassesInMissedCyclesToo) {
  MoteusRig rig;
  rig.enable();  // and stays so, at rest
  rig.cycles(100, DriveGoal::kQuickStop);
  rig.drive.coast(300);
  rig.cycles(kMoteusDeadlineCycles - 400, DriveGoal::kQuickStop);
  EXPECT_FALSE(rig.drive.report().is_cut_off);
  rig.cycle(DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.drive.report().is_cut_off);
}

/// Cycles of a quick stop until one is seen to move on that turns at this speed, with replies so
/// often in a cycle, but for the last of these cycles of each 15.
int cyclesUntilSeen(double turns_per_s, int replies, int missing) {
  MoteusRig rig;
  rig.enable();
  int cycles = 0;
  for (; !rig.drive.report().is_moving_on && cycles < kMoteusDeadlineCycles; ++cycles) {
    rig.turns += static_cast<float>(turns_per_s * test::kPeriod_s);
    for (int i = 0; i < replies && cycles % 15 < 15 - missing; ++i)
      rig.drive.receive(moteusReply(10, rig.turns, 0.0F, 0));
    rig.quietCycle(DriveGoal::kQuickStop);
  }
  return cycles;
}

/// Gaps that are no silence begin no window anew, and repeated replies make time pass no faster
/// than a late one does.
TEST(MoteusStop, OneThatMovesOnIsSeenAlsoThroughGapsAndRepeatedReplies) {
  EXPECT_LE(cyclesUntilSeen(0.15, 1, 0), 110);
  EXPECT_LE(cyclesUntilSeen(0.15, 1, MoteusDrive::kMaxSilentCycles), 300);
  EXPECT_LE(cyclesUntilSeen(0.03, 4, 0), 110);
}

TEST(MoteusStop, OneThatWasNotHeardOfWhileItSlowedDownDoesNotMoveOn) {
  MoteusRig rig;
  rig.enable();
  for (int i = 0; i < 60; ++i) {
    rig.turns += 1e-4F;
    rig.cycle(DriveGoal::kQuickStop);
  }
  for (int i = 0; i < 20; ++i) rig.quietCycle(DriveGoal::kQuickStop);
  rig.turns += 0.02F;  // and rests there
  for (int i = 0; i < 200; ++i) {
    rig.cycle(DriveGoal::kQuickStop);
    ASSERT_FALSE(rig.drive.report().is_moving_on) << i;
  }
}

TEST(MoteusStop, OneThatDoesNotFollowIsAFaultWhileItIsToFollow) {
  for (const bool is_enabled : {false, true}) {
    MoteusRig rig;
    is_enabled ? rig.enable() : rig.configure();
    rig.position = rig.drive.report().position + 0.0499;  // of DriveConfig::max_following_error
    rig.cycle(DriveGoal::kEnabled);
    EXPECT_EQ(rig.drive.report().fault, Fault::kNone);
    rig.position = rig.drive.report().position + 0.0501;
    rig.cycle(is_enabled ? DriveGoal::kEnabled : DriveGoal::kDisabled);
    EXPECT_EQ(rig.drive.report().fault, is_enabled ? Fault::kFollowingError : Fault::kNone);
  }
}

TEST(MoteusStop, OneIsOffInItsModesWithoutTorque) {
  for (int mode = 0; mode < 17; ++mode) {
    MoteusRig rig;
    rig.configure();
    rig.mode = mode;
    rig.cycle(DriveGoal::kDisabled);
    const bool is_known = mode <= 4 || (mode >= 10 && mode <= 12) || mode == 15;
    EXPECT_EQ(rig.drive.report().has_state, is_known) << mode;
    EXPECT_EQ(rig.drive.report().is_off, mode == 0 || mode == 1) << mode;
  }
}

/// At the end it is told to stay off; any other has its watchdog, which letting go would cut short.
TEST(MoteusStop, OnlyWhatWasSeenOffIsStoppedAtTheEnd) {
  for (const bool is_off : {false, true}) {
    MoteusRig rig;
    rig.enable();
    rig.mode = is_off ? 0 : 10;
    rig.cycle(DriveGoal::kQuickStop);
    FrameBatch out;
    rig.drive.release(out);
    const std::vector<CanFrame> frames{out.begin(), out.end()};
    if (is_off)
      EXPECT_EQ(frames,
                std::vector{moteusCommandFrame(kMoteusNode, {.kind = MoteusCommand::Kind::kStop})});
    else
      EXPECT_TRUE(frames.empty());
  }
}

}  // namespace
}  // namespace tactus
