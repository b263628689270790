#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <ostream>

#include "support/drive_rig.h"
#include "tactus/canopen/joint_tracking.h"

/// A drive that fails while it moves: the fault has its name, no velocity is sent from that very
/// cycle on, and only a restart leads back.
namespace tactus {
namespace {

using test::commandOf;
using test::DriveRig;
using test::kNode;
using test::rawFrame;
using test::ScriptedDrive;

constexpr double kVelocity = 0.1;

struct Trouble {
  const char* name;
  std::function<void(DriveRig&)> strike;
  Fault fault;
  int cycles;  ///< until it has to be seen
};
void PrintTo(const Trouble& trouble, std::ostream* out) { *out << trouble.name; }

class DriveFault : public testing::TestWithParam<Trouble> {
 protected:
  void SetUp() override {
    rig.enable();
    rig.cycles(30, DriveGoal::kEnabled, kVelocity);
    ASSERT_NE(rig.slave.velocity, 0);
    GetParam().strike(rig);
  }
  void TearDown() override { EXPECT_EQ(rig.report().fault, GetParam().fault); }

  /// Frames of cycles in which the daemon still wants motion, until the fault is seen.
  void meetFault() {
    for (int cycle = 1; cycle <= GetParam().cycles; ++cycle) {
      const auto frames = rig.cycle(DriveGoal::kEnabled, kVelocity);
      if (rig.report().fault == Fault::kNone) continue;
      EXPECT_EQ(cycle, GetParam().cycles) << "earlier than it has to be seen";
      expectStopped(frames);
      return;
    }
    ADD_FAILURE() << "not seen in " << GetParam().cycles << " cycles";
  }

  void expectStopped(const std::vector<CanFrame>& frames) {
    if (!rig.report().is_configured) {  // its mapping is gone
      for (const CanFrame& frame : frames) EXPECT_EQ(frame, rawFrame(0, {129, kNode}));
    } else {
      const DriveCommand command = commandOf(frames);
      EXPECT_EQ(command.velocity, 0);
      EXPECT_EQ(command.control_word, 0x02);
    }
  }

  DriveRig rig;
};

TEST_P(DriveFault, StopsItInTheCycleInWhichItIsSeen) {
  meetFault();
  for (int cycle = 0; cycle < 100; ++cycle)
    expectStopped(rig.cycle(DriveGoal::kEnabled, kVelocity));
}

TEST_P(DriveFault, StaysWhateverIsAskedForButARestart) {
  meetFault();
  for (DriveGoal goal : {DriveGoal::kQuickStop, DriveGoal::kDisabled, DriveGoal::kConfigure,
                         DriveGoal::kSilent, DriveGoal::kEnabled}) {
    for (int cycle = 0; cycle < 30; ++cycle) {
      for (const CanFrame& frame : rig.cycle(goal, kVelocity)) {
        if (frame == rawFrame(0, {129, kNode})) continue;
        EXPECT_EQ(frame.id, 0x200u + kNode);
        EXPECT_EQ(rawFrame(0, {frame.data[2], frame.data[3], frame.data[4], frame.data[5]}),
                  rawFrame(0, {0, 0, 0, 0}));
        EXPECT_EQ(frame.data[0] & 0x80, 0) << "cleared without a restart";
      }
      ASSERT_EQ(rig.report().fault, GetParam().fault);
    }
  }
  EXPECT_EQ(rig.slave.resets, 0);
}

TEST_P(DriveFault, IsForgottenByARestart) {
  meetFault();
  rig.cycles(30, DriveGoal::kQuickStop);
  const Fault before = rig.report().fault;
  rig.slave.is_powered = true;
  rig.slave.sends_feedback = true;
  rig.slave.sends_heartbeat = true;
  rig.enable();
  EXPECT_EQ(rig.slave.power, ScriptedDrive::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  EXPECT_LE(rig.slave.resets, 1);
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, kVelocity)).velocity, -20000);
  // For TearDown: what it was.
  EXPECT_EQ(before, GetParam().fault);
  GetParam().strike(rig);
  meetFault();
}

Trouble says(const char* name, const std::vector<int>& bytes, std::uint32_t function, Fault fault) {
  return {name, [=](DriveRig& rig) { rig.slave.say(function, bytes); }, fault, 1};
}

Trouble feedbackWith(const char* name, int status, Fault fault) {
  return {name,
          [=](DriveRig& rig) {
            const auto p = static_cast<std::uint32_t>(rig.slave.position);
            rig.slave.say(0x180, {status, 0x16, int(p & 0xFF), int(p >> 8 & 0xFF),
                                  int(p >> 16 & 0xFF), int(p >> 24)});
          },
          fault, 1};
}

const std::vector<Trouble> kTroubles = {
    {"fault", [](DriveRig& rig) { rig.slave.fault(0x7500); }, Fault::kDriveFault, 1},
    says("emergency", {0x10, 0x23, 0x02, 0, 0, 0, 0, 0}, 0x080, Fault::kDriveFault),
    feedbackWith("fault_reaction", 0x1F, Fault::kDriveFault),
    feedbackWith("fault_without_emergency", 0x18, Fault::kDriveFault),
    feedbackWith("switched_on", 0x33, Fault::kDriveStateLost),
    feedbackWith("quick_stop", 0x17, Fault::kDriveStateLost),
    feedbackWith("switch_on_disabled", 0x50, Fault::kDriveStateLost),
    feedbackWith("unknown_status", 0x7F, Fault::kDriveStateLost),
    says("pre_operational", {0x7F}, 0x700, Fault::kDriveStateLost),
    says("stopped", {0x04}, 0x700, Fault::kDriveStateLost),
    {"power_cycle", [](DriveRig& rig) { rig.slave.powerUp(); }, Fault::kDriveStateLost, 1},
    // The feedback of the cycle before is on its way; five more may be missing.
    {"no_feedback", [](DriveRig& rig) { rig.slave.sends_feedback = false; }, Fault::kDriveSilent,
     7},
    {"power_cut", [](DriveRig& rig) { rig.slave.is_powered = false; }, Fault::kDriveSilent, 7},
    {"not_following", [](DriveRig& rig) { rig.position += 0.051; }, Fault::kFollowingError, 1},
    {"not_following_down", [](DriveRig& rig) { rig.position -= 0.051; }, Fault::kFollowingError, 1},
    {"position_not_finite", [](DriveRig& rig) { rig.position = std::nan(""); },
     Fault::kCommandNotFinite, 1},
};

INSTANTIATE_TEST_SUITE_P(Troubles, DriveFault, testing::ValuesIn(kTroubles),
                         [](const auto& trouble) { return std::string(trouble.param.name); });

TEST(DriveFaults, ToleratesEmergenciesOfAnOldFault) {
  DriveRig rig;
  rig.cycle(DriveGoal::kConfigure, 0.0, true);
  rig.slave.fault(0x8130);
  rig.until([&] { return rig.report().is_configured; }, DriveGoal::kConfigure);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  EXPECT_EQ(rig.report().emergency_code, 0x8130);
  rig.position = rig.report().position;
  rig.cycles(20, DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().state, DriveState::kOperationEnabled);
}

TEST(DriveFaults, AnOldFaultStaysOneAsLongAsItIsNotLeft) {
  DriveRig rig;
  rig.slave.power = ScriptedDrive::kFault;
  rig.configure();
  rig.cycle(DriveGoal::kDisabled);
  rig.slave.say(0x080, {0x10, 0x23, 0x02, 0, 0, 0, 0, 0});
  rig.cycle(DriveGoal::kDisabled);
  rig.slave.take();  // in place of its feedback, one that nobody knows
  rig.slave.say(0x180, {0x7F, 0, 0, 0, 0, 0});
  rig.cycle(DriveGoal::kDisabled);
  rig.cycles(5, DriveGoal::kDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  EXPECT_EQ(rig.report().state, DriveState::kFault);
  rig.position = rig.report().position;
  rig.cycles(20, DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().state, DriveState::kOperationEnabled);
}

TEST(DriveFaults, LosingOperationSoonAfterItWasGivenIsOneToo) {
  DriveRig rig;
  rig.configure();
  rig.until([&] { return rig.report().state == DriveState::kOperationEnabled; },
            DriveGoal::kEnabled);
  rig.cycles(2, DriveGoal::kEnabled);
  rig.slave.power = ScriptedDrive::kOn;
  rig.cycles(3, DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kDriveStateLost);
}

/// What a drive shows on its way counts once it was seen for three cycles.
TEST(DriveFaults, LosingOperationAtOnceIsNone) {
  for (const int more : {0, 1}) {
    DriveRig rig;
    rig.configure();
    rig.until([&] { return rig.report().state == DriveState::kOperationEnabled; },
              DriveGoal::kEnabled);
    rig.cycles(more, DriveGoal::kEnabled);
    rig.slave.power = ScriptedDrive::kOn;
    rig.cycles(3, DriveGoal::kEnabled);
    EXPECT_EQ(rig.report().fault, more == 0 ? Fault::kNone : Fault::kDriveStateLost);
  }
}

TEST(DriveFaults, NewFaultWhileDisabledIsOneToo) {
  DriveRig rig;
  rig.configure();
  rig.cycles(10, DriveGoal::kDisabled);
  rig.slave.power = ScriptedDrive::kFault;
  rig.cycles(3, DriveGoal::kDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kDriveFault);
  rig.cycles(100, DriveGoal::kEnabled);
  EXPECT_EQ(rig.slave.resets, 0);
}

TEST(DriveFaults, MissesTheHeartbeatInTime) {
  DriveRig rig;
  rig.enable();
  // Until just after a heartbeat: it has come, and the next will not.
  for (int cycle = 0; cycle < 40; ++cycle) rig.cycle(DriveGoal::kEnabled);
  rig.slave.sends_heartbeat = false;
  int cycles = 0;
  while (rig.report().fault == Fault::kNone && cycles < 100) {
    rig.cycle(DriveGoal::kEnabled);
    ++cycles;
  }
  EXPECT_EQ(rig.report().fault, Fault::kDriveSilent);
  EXPECT_STREQ(rig.report().detail.unit, "cycles without heartbeat");
  EXPECT_EQ(rig.report().detail.value, 61.0);
  EXPECT_EQ(rig.report().detail.limit, 60.0);
  EXPECT_GT(cycles, 60 - 20);
  EXPECT_LE(cycles, 60 + 2);
}

TEST(DriveFaults, VelocityThatIsNoNumberStopsTheDrive) {
  for (double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -HUGE_VAL}) {
    DriveRig rig;
    rig.enable();
    rig.cycles(10, DriveGoal::kEnabled, kVelocity);
    EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, bad)), (DriveCommand{0x02, 0}));
    EXPECT_EQ(rig.report().fault, Fault::kCommandNotFinite);
    EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, kVelocity)), (DriveCommand{0x02, 0}));
  }
}

TEST(DriveFaults, VelocityBeyondTheCountsSaturates) {
  DriveConfig config = test::driveConfig();
  config.max_velocity = std::numeric_limits<double>::infinity();
  DriveRig rig(config);
  rig.enable();
  EXPECT_EQ(commandOf(rig.cycle(DriveGoal::kEnabled, 1e300)), (DriveCommand{0x0F, -2147483647}));
}

TEST(DriveFaults, FollowingErrorIsWatchedOnlyWhileEnabled) {
  DriveRig rig;
  rig.configure();
  rig.position += 10.0;
  rig.cycles(20, DriveGoal::kDisabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
  rig.position = rig.report().position + 0.0499;
  rig.cycles(20, DriveGoal::kEnabled);
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

TEST(DriveFaults, AFollowingErrorIsMoreThanItsLimit) {
  DriveConfig config;
  config.max_following_error = 0.0625;
  for (const double side : {-1.0, 1.0}) {
    const auto at = [](double position) { return CommandedPlace{position, position}; };
    DriveReport report;
    report.position = 0.25;
    judgePosition(config, at(0.25 + side * 0.0625), true, report);
    EXPECT_EQ(report.fault, Fault::kNone);
    judgePosition(config, at(0.25 + side * 0.0626), false, report);
    EXPECT_EQ(report.fault, Fault::kNone) << "of an old position";
    judgePosition(config, at(0.25 + side * 0.0626), true, report);
    EXPECT_EQ(report.fault, Fault::kFollowingError);
    EXPECT_NEAR(report.detail.value, 0.0626, 1e-12);
  }
}

/// It may have been measured at the pause's begin, at its end or between.
TEST(DriveFaults, AFollowingErrorAfterAPauseIsFarFromAllPlacesInIt) {
  DriveConfig config;
  config.max_following_error = 0.0625;
  const auto isTooFar = [&](double position, double before, double now) {
    DriveReport report;
    report.position = position;
    judgePosition(config, {now, before}, true, report);
    return report.fault == Fault::kFollowingError;
  };
  for (const double side : {-1.0, 1.0}) {
    for (const double way : {-0.0625, 0.0, 0.5, 1.0, 1.0625})
      EXPECT_FALSE(isTooFar(side * way, 0.0, side)) << way;
    for (const double way : {-0.0626, 1.0626}) EXPECT_TRUE(isTooFar(side * way, 0.0, side)) << way;
  }
  DriveReport report;
  judgePosition(config, {0.0, NAN}, true, report);
  EXPECT_EQ(report.fault, Fault::kCommandNotFinite);
}

/// The bus dies for five seconds and comes back: nothing of before reaches the drive.
TEST(DriveFaults, PowerThatReturnsFindsNoSetpoint) {
  DriveRig rig;
  rig.enable();
  rig.cycles(30, DriveGoal::kEnabled, kVelocity);
  rig.slave.is_powered = false;
  rig.cycles(5000, DriveGoal::kQuickStop, kVelocity);
  EXPECT_EQ(rig.report().fault, Fault::kDriveSilent);
  EXPECT_STREQ(rig.report().detail.unit, "cycles without feedback");
  EXPECT_EQ(rig.report().detail.value, 6.0);
  EXPECT_EQ(rig.report().detail.limit, 5.0);
  rig.slave.powerUp();
  for (int cycle = 0; cycle < 100; ++cycle) {
    const auto frames = rig.cycle(DriveGoal::kEnabled, kVelocity);
    if (cycle == 0) continue;
    for (const CanFrame& frame : frames) EXPECT_EQ(frame, rawFrame(0, {129, kNode}));
  }
  EXPECT_EQ(rig.slave.velocity, 0);
  EXPECT_EQ(rig.slave.power, ScriptedDrive::kDisabled);
  rig.enable();
  EXPECT_EQ(rig.report().fault, Fault::kNone);
}

}  // namespace
}  // namespace tactus
