#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "support/drive_rig.h"

/// What single frames mean to a drive's master, or do not.
namespace tactus {
namespace {

using test::commandOf;
using test::DriveRig;
using test::kNode;
using test::rawFrame;

constexpr double kSetpoint = 0.1;

TEST(DriveFrames, CountsAndIgnoresFramesOfWrongSize) {
  DriveRig rig;
  rig.enable();
  std::uint32_t wrong = 0;
  const std::pair<std::uint32_t, int> kinds[] = {
      {0x180 + kNode, 6}, {0x700 + kNode, 1}, {0x080 + kNode, 8}, {0x580 + kNode, 8}};
  for (const auto& [id, right] : kinds) {
    for (int size = 0; size <= 8; ++size) {
      if (size == right) continue;
      rig.drive.receive(rawFrame(id, std::vector<int>(size, 0)));
      ++wrong;
    }
  }
  rig.drive.receive(rawFrame(0x700 + kNode, {0x33}));
  EXPECT_EQ(rig.drive.malformedFrames(), wrong + 1);
  rig.cycles(3, DriveGoal::kEnabled, kSetpoint);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  EXPECT_EQ(rig.report().emergency_code, 0);
}

TEST(DriveFrames, FramesOfOthersAreNothingToIt) {
  DriveRig rig;
  rig.enable();
  for (std::uint32_t id = 0; id < 0x800; ++id) {
    const bool is_mine = id == 0x180u + kNode || id == 0x700u + kNode || id == 0x080u + kNode;
    if (!is_mine) rig.drive.receive(rawFrame(id, {0x00, 0x7F, 0, 0, 0, 0, 0, 0}));
  }
  for (std::uint32_t function : {0x180u, 0x700u, 0x080u}) {
    CanFrame frame = rawFrame(function + kNode, {0x08, 0, 0, 0, 0, 0});
    if (function == 0x700) frame.size = 1;
    if (function == 0x080) frame.size = 8;
    frame.extended = true;
    rig.drive.receive(frame);
    frame.extended = false;
    frame.is_fd = true;
    rig.drive.receive(frame);
    frame.is_fd = false;
    for (FrameKind kind : {FrameKind::kRemote, FrameKind::kError}) {
      frame.kind = kind;
      rig.drive.receive(frame);
    }
  }
  rig.cycle(DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  EXPECT_EQ(rig.drive.malformedFrames(), 0u);
}

TEST(DriveFrames, ShortGapsOfFeedbackAreBridged) {
  DriveRig rig;
  rig.enable();
  for (int gap = 0; gap < 20; ++gap) {
    rig.cycles(1, DriveGoal::kEnabled, kSetpoint);
    rig.slave.sends_feedback = false;
    for (int cycle = 0; cycle < Drive::kMaxSilentCycles; ++cycle)
      EXPECT_NE(commandOf(rig.cycle(DriveGoal::kEnabled, kSetpoint)).velocity, 0);
    rig.slave.sends_feedback = true;
  }
  rig.cycles(2, DriveGoal::kEnabled, kSetpoint);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

/// As of the master that has gone: nothing of it is of a later fault.
TEST(DriveFrames, ForgetsTheEmergencyOfBeforeItWasSetUp) {
  DriveRig rig;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.slave.say(0x080, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0});
  rig.cycle(DriveGoal::kConfigure);
  EXPECT_EQ(rig.report().emergency_code, 0x8130);
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
  EXPECT_EQ(rig.report().emergency_code, 0);
  rig.position = rig.report().position;
  rig.cycles(20, DriveGoal::kEnabled);
  rig.slave.power = test::ScriptedDrive::kFault;
  rig.cycles(3, DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kDriveFault);
  EXPECT_TRUE(std::isnan(rig.report().detail.value)) << "none is told";
}

TEST(DriveFrames, NamesTheEmergencyUntilItHasGone) {
  DriveRig rig;
  rig.enable();
  rig.slave.say(0x080, {0, 0, 0, 0, 0, 0, 0, 0});
  rig.cycle(DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone) << "error reset is none";
  rig.slave.fault(0x7500);
  rig.cycle(DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().emergency_code, 0x7500);
  rig.slave.say(0x080, {0, 0, 0, 0, 0, 0, 0, 0});
  rig.cycle(DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().emergency_code, 0);
  EXPECT_EQ(rig.report().fault, Fault::kDriveFault) << "stays until restart";
}

}  // namespace
}  // namespace tactus
