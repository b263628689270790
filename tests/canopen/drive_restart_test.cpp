#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/drive_rig.h"

/// Drives that say that they boot while they are configured: reset until they really have.
namespace tactus {
namespace {

using test::DriveRig;
using test::kNode;
using test::rawFrame;

const CanFrame kNodeReset = rawFrame(0, {129, kNode});
constexpr int kAnswerCycles = 100;     // CanopenConfig::sdo_timeout_s
constexpr int kHeartbeatCycles = 60;   // CanopenConfig::heartbeat_timeout_s
const std::vector<int> kBootUp = {0};  // by its heartbeat
const std::vector<int> kOperational = {5};

bool isReset(const std::vector<CanFrame>& frames) {
  return std::find(frames.begin(), frames.end(), kNodeReset) != frames.end();
}

/// Enabled; from now on it says only what the test lets it say.
DriveRig quietDrive() {
  DriveRig rig;
  rig.enable();
  rig.slave.take();
  rig.slave.ignores_commands = rig.slave.ignores_nmt = true;
  rig.slave.sends_feedback = rig.slave.sends_heartbeat = false;
  return rig;
}

/// Cycles in which it is reset, where it boots in cycle 0 and is heard in these.
std::vector<int> resetsOf(const std::vector<int>& heard) {
  DriveRig rig = quietDrive();
  std::vector<int> resets;
  for (int cycle = 0; cycle < 400; ++cycle) {
    if (cycle == 0) rig.slave.say(0x700, kBootUp);
    if (std::find(heard.begin(), heard.end(), cycle) != heard.end())
      rig.slave.say(0x700, kOperational);
    if (isReset(rig.cycle(DriveGoal::kQuickStop))) resets.push_back(cycle);
  }
  return resets;
}

/// It has the time of an answer to boot, each time anew, and is not reset while nobody hears it.
TEST(DriveRestart, IsRepeatedWhereTheDriveIsHeardThoughItShouldBeBooting) {
  EXPECT_EQ(resetsOf({}), (std::vector{0}));
  EXPECT_EQ(resetsOf({50, kAnswerCycles}), (std::vector{0}));
  EXPECT_EQ(resetsOf({kAnswerCycles + 1}), (std::vector{0, kAnswerCycles + 1}));
  EXPECT_EQ(resetsOf({101, 102, 110, 201}), (std::vector{0, 101}));
  EXPECT_EQ(resetsOf({101, 201, 202, 390}), (std::vector{0, 101, 202, 390}));
}

TEST(DriveRestart, BeginsAtOnceWhereTheDriveRunsOnAfterIt) {
  DriveRig rig = quietDrive();
  rig.slave.say(0x700, kBootUp);
  EXPECT_TRUE(isReset(rig.cycle(DriveGoal::kQuickStop)));
  rig.slave.say(0x700, kBootUp);
  EXPECT_FALSE(isReset(rig.cycle(DriveGoal::kQuickStop)));
  EXPECT_TRUE(rig.report().is_off) << "it has booted";
  rig.slave.say(0x180, {0x37, 0x16, 0, 0, 0, 0});
  EXPECT_TRUE(isReset(rig.cycle(DriveGoal::kQuickStop))) << "one that has sends no feedback";
  EXPECT_TRUE(rig.report().is_restarting);
  EXPECT_FALSE(rig.report().is_off);
}

/// What it said before it could hear of its reset proves nothing.
TEST(DriveRestart, IsNotOverByABootUpOfBefore) {
  DriveRig rig = quietDrive();
  rig.slave.say(0x700, kBootUp);
  rig.slave.say(0x700, kBootUp);
  EXPECT_TRUE(isReset(rig.cycle(DriveGoal::kQuickStop)));
  EXPECT_TRUE(rig.report().is_restarting);
  EXPECT_FALSE(rig.report().is_off);
}

/// By feedback or by heartbeat, either says that it is there.
TEST(DriveRestart, IsOutOfReachOnceNothingIsHeardForTheHeartbeatTimeout) {
  for (const bool by_feedback : {false, true}) {
    DriveRig rig = quietDrive();
    rig.slave.say(0x700, kBootUp);
    rig.cycle(DriveGoal::kQuickStop);
    const auto isSilent = [&rig] {
      rig.cycle(DriveGoal::kQuickStop);
      return rig.report().is_silent;
    };
    for (int cycle = 0; cycle < 3 * kHeartbeatCycles; ++cycle) {
      if (by_feedback)
        rig.slave.say(0x180, {0x37, 0x16, 0, 0, 0, 0});
      else if (cycle % 20 == 19)
        rig.slave.say(0x700, kOperational);
      ASSERT_FALSE(isSilent()) << cycle;
    }
    const int more = kHeartbeatCycles - (by_feedback ? 0 : 1);  // from the cycle it came in
    for (int cycle = 0; cycle < more; ++cycle) ASSERT_FALSE(isSilent()) << cycle;
    EXPECT_TRUE(isSilent());
    rig.slave.say(0x180, {0x37, 0x16, 0, 0, 0, 0});
    EXPECT_FALSE(isSilent());
  }
}

TEST(DriveRestart, MakesItsStateUnknown) {
  DriveRig rig = quietDrive();
  ASSERT_EQ(rig.report().state, DriveState::kOperationEnabled);
  rig.slave.say(0x700, kBootUp);
  rig.cycle(DriveGoal::kQuickStop);
  EXPECT_FALSE(rig.report().has_state);
  EXPECT_NE(rig.report().state, DriveState::kOperationEnabled);
  EXPECT_FALSE(rig.report().is_configured);
}

}  // namespace
}  // namespace tactus
