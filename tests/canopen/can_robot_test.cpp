#include "tactus/canopen/can_robot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "canopen/tactile_frames.h"
#include "support/period.h"
#include "support/random.h"
#include "support/scripted_drive.h"
#include "tactus/canopen/canopen.h"

/// What a robot says of its drives, where they do not all do the same.
namespace tactus {
namespace {

using test::ScriptedDrive;

struct RobotRig {
  explicit RobotRig(const HardwareConfig& config = hardware()) : robot(config, test::kPeriod_s) {}

  static HardwareConfig hardware() {
    HardwareConfig config;
    config.buses.resize(1);
    for (int i = 0; i < 2; ++i) {
      config.drives.emplace_back();
      config.drives.back().joint = i;
      config.drives.back().node_id = i + 1;
    }
    return config;
  }

  void cycle(DriveGoal goal, bool is_restart = false) {
    for (ScriptedDrive& slave : slaves) robot.receive(0, slave.take());
    RobotInput input;
    robot.read(input);
    robot.command(goal, is_restart, input.q_measured);
    write(JointVector::Zero(2));
  }
  void write(const JointVector& velocity) {
    robot.write(velocity);
    for (const CanFrame& frame : robot.outbox(0))
      for (ScriptedDrive& slave : slaves) slave.hear(frame);
  }
  void cycles(int count, DriveGoal goal) {
    for (int i = 0; i < count; ++i) cycle(goal);
  }
  /// Both enabled.
  void enable() {
    cycle(DriveGoal::kConfigure, true);
    for (int i = 0; i < 500 && !robot.drives().are_configured; ++i) cycle(DriveGoal::kConfigure);
    for (int i = 0; i < 100 && !robot.drives().are_enabled; ++i) cycle(DriveGoal::kEnabled);
  }

  CanRobot robot;
  ScriptedDrive slaves[2] = {ScriptedDrive(1), ScriptedDrive(2)};
};

TEST(CanRobot, IsNotOffWhileOneOfItsDrivesHasPower) {
  for (const int deaf : {0, 1}) {
    RobotRig rig;
    rig.enable();
    EXPECT_TRUE(rig.robot.drives().are_enabled);
    EXPECT_FALSE(rig.robot.drives().are_disabled);
    rig.slaves[deaf].ignores_commands = true;
    rig.cycles(20, DriveGoal::kDisabled);
    ASSERT_EQ(rig.slaves[1 - deaf].power, ScriptedDrive::kDisabled);
    EXPECT_FALSE(rig.robot.drives().are_disabled) << deaf;
    EXPECT_FALSE(rig.robot.drives().are_enabled) << deaf;
    EXPECT_TRUE(rig.robot.drives().is_any_holding) << deaf;
    EXPECT_TRUE(rig.robot.isHolding(deaf));
    EXPECT_FALSE(rig.robot.isHolding(1 - deaf));
    rig.slaves[deaf].ignores_commands = false;
    rig.cycles(20, DriveGoal::kDisabled);
    EXPECT_TRUE(rig.robot.drives().are_disabled) << deaf;
    EXPECT_FALSE(rig.robot.drives().is_any_holding) << deaf;
    EXPECT_FALSE(rig.robot.isHolding(deaf));
  }
}

/// Of several that fail the first is named, and none where none does.
TEST(CanRobot, NamesTheFirstOfItsDrivesThatFails) {
  for (const int failing : {0, 1, 2, 3}) {  // by bits
    RobotRig rig;
    rig.enable();
    EXPECT_EQ(rig.robot.drives().joint, -1);
    if ((failing & 1) != 0) rig.slaves[0].fault(0x7500);
    if ((failing & 2) != 0) rig.slaves[1].sends_feedback = false;
    rig.cycles(20, DriveGoal::kEnabled);
    const DrivesReport all = rig.robot.drives();
    EXPECT_EQ(all.joint, failing == 0 ? -1 : failing == 2 ? 1 : 0);
    EXPECT_EQ(all.fault, failing == 0   ? Fault::kNone
                         : failing == 2 ? Fault::kDriveSilent
                                        : Fault::kDriveFault);
  }
}

/// It says that it boots: whatever it said of its power is of before.
TEST(CanRobot, IsNotHeldByADriveThatHasBooted) {
  RobotRig rig;
  rig.enable();
  EXPECT_TRUE(rig.robot.isHolding(0));
  rig.slaves[0].powerUp();
  rig.cycles(10, DriveGoal::kQuickStop);
  EXPECT_FALSE(rig.robot.isHolding(0));
  EXPECT_EQ(rig.robot.drives().joint, 0);
}

/// By these drives know that it runs; by SYNC they take what they were told.
TEST(CanRobot, TellsThatItRunsInItsPeriod) {
  HardwareConfig hardware = RobotRig::hardware();
  hardware.canopen.heartbeat_period_s = 0.007;
  hardware.buses.resize(2);  // the second has no drive
  CanRobot robot(hardware, test::kPeriod_s);
  for (int cycle = 0; cycle < 50; ++cycle) {
    robot.write(JointVector::Zero(2));
    const auto& frames = robot.outbox(0);
    const auto heartbeats = std::ranges::count(
        frames, heartbeatFrame(hardware.canopen.master_node_id, NmtState::kOperational));
    EXPECT_EQ(heartbeats, cycle % 7 == 0 ? 1 : 0) << cycle;
    EXPECT_EQ(std::ranges::count(frames, syncFrame()), 1);
    EXPECT_TRUE(std::ranges::empty(robot.outbox(1)));
  }
}

bool hasHeartbeat(const CanRobot& robot) {
  const auto& frames = robot.outbox(0);
  return std::ranges::count(frames, heartbeatFrame(127, NmtState::kOperational)) == 1;
}

/// Drives count from its last heartbeat on, whatever the cycle is.
TEST(CanRobot, NeverTellsLaterThanInItsPeriodThatItRuns) {
  HardwareConfig hardware = RobotRig::hardware();
  for (const double heartbeat_s : {0.002, 0.005, 0.007, 0.02, 0.05}) {
    hardware.canopen.heartbeat_period_s = heartbeat_s;
    for (const double period_s : {0.001, 0.00125, 0.0015, 0.002}) {
      CanRobot robot(hardware, period_s);
      int since = 0, longest = 0;
      for (int cycle = 0; cycle < 1000; ++cycle) {
        robot.write(JointVector::Zero(2));
        longest = std::max(longest, since);
        since = hasHeartbeat(robot) ? 1 : since + 1;
      }
      EXPECT_LE(longest * period_s, heartbeat_s + 1e-9) << heartbeat_s << " " << period_s;
      EXPECT_GT((longest + 1) * period_s, heartbeat_s + 1e-9) << heartbeat_s << " " << period_s;
    }
  }
}

TEST(CanRobot, TellsAtOnceThatItRunsWhereItsPeriodHasPassedInMissedCycles) {
  HardwareConfig hardware = RobotRig::hardware();
  hardware.canopen.heartbeat_period_s = 0.007;
  CanRobot robot(hardware, test::kPeriod_s);
  robot.write(JointVector::Zero(2));
  robot.coast(6);
  robot.write(JointVector::Zero(2));
  EXPECT_TRUE(hasHeartbeat(robot));
  robot.coast(3);
  for (int cycle = 0; cycle < 4; ++cycle) {
    robot.write(JointVector::Zero(2));
    EXPECT_EQ(hasHeartbeat(robot), cycle == 3) << cycle;
  }
}

/// The last word: each drive is told, and nothing else is.
TEST(CanRobot, ReleasesEachOfItsDrives) {
  RobotRig rig;
  rig.enable();
  rig.robot.release();
  const auto frames = rig.robot.outbox(0);
  ASSERT_EQ(std::ranges::size(frames), 2u);
  for (const int node : {1, 2})
    EXPECT_EQ(std::ranges::count(frames, nmtFrame({NmtCommand::kResetNode, node})), 1) << node;
}

TEST(CanRobot, TellsWhereItsJointsAreOnceAllSaySo) {
  RobotRig rig;
  RobotInput input;
  rig.slaves[0].position = 250000;  // of 1e6 a unit
  rig.slaves[1].position = -500000;
  rig.slaves[1].sends_feedback = false;
  rig.cycle(DriveGoal::kConfigure, true);
  EXPECT_FALSE(rig.robot.hasPositions());
  for (int i = 0; i < 100; ++i) rig.cycle(DriveGoal::kConfigure);
  ASSERT_TRUE(rig.robot.drive(0).has_position);
  EXPECT_FALSE(rig.robot.hasPositions()) << "one has yet to be heard";
  rig.slaves[1].sends_feedback = true;
  rig.enable();
  EXPECT_TRUE(rig.robot.hasPositions());
  rig.robot.read(input);
  ASSERT_EQ(input.q_measured.size(), 2);
  EXPECT_EQ(input.q_measured, (JointVector(2) << 0.25, -0.5).finished());
}

TEST(CanRobot, ProbesADeadBusMoreSeldomThanItsDrivesWait) {
  test::Random random(5);
  CanopenConfig canopen;
  for (int i = 0; i < 1000; ++i) {
    const double period_s = random.uniform(0.0005, 0.02);
    canopen.heartbeat_timeout_s = random.uniform(0.01, 2.0);
    const int cycles = probeCycles(canopen, period_s);
    EXPECT_GE(cycles, 100);
    EXPECT_GE(cycles * period_s, 1.4999 * canopen.heartbeat_timeout_s);
    EXPECT_TRUE(cycles == 100 || (cycles - 1) * period_s < 1.5001 * canopen.heartbeat_timeout_s);
  }
}

/// What nobody hears of is not counted among what has power: its own watch stops it.
TEST(CanRobot, CountsThePowerOfDrivesInReachAlone) {
  RobotRig rig;
  EXPECT_FALSE(rig.robot.hasPower(0)) << "not set up";
  EXPECT_FALSE(rig.robot.drives().is_any_holding);
  EXPECT_TRUE(rig.robot.drives().are_disabled);
  EXPECT_EQ(rig.robot.firstWithPower(), -1);
  rig.enable();
  EXPECT_TRUE(rig.robot.hasPower(0));
  EXPECT_TRUE(rig.robot.hasPower(1));
  EXPECT_EQ(rig.robot.firstWithPower(), 0);
  rig.slaves[0].sends_feedback = false;
  rig.slaves[0].ignores_commands = true;
  rig.cycles(20, DriveGoal::kEnabled);
  EXPECT_EQ(rig.robot.firstWithPower(), 1);
  rig.cycles(20, DriveGoal::kDisabled);
  ASSERT_TRUE(rig.robot.drive(0).is_silent);
  EXPECT_EQ(rig.robot.drive(0).state, DriveState::kOperationEnabled) << "an old one";
  for (const int joint : {0, 1}) {
    EXPECT_FALSE(rig.robot.hasPower(joint)) << joint;
    EXPECT_FALSE(rig.robot.isHolding(joint)) << joint;
  }
  EXPECT_FALSE(rig.robot.drives().is_any_holding);
  EXPECT_TRUE(rig.robot.drives().are_disabled);
}

/// One that still tells how it stops is in reach, or the brake would close on it.
TEST(CanRobot, IsHeldByADriveThatLacksItsHeartbeatAlone) {
  RobotRig rig;
  rig.enable();
  rig.slaves[0].sends_heartbeat = false;
  rig.slaves[0].quick_stop_cycles = 100;
  for (int i = 0; i < 200 && rig.robot.drives().fault == Fault::kNone; ++i)
    rig.cycles(1, DriveGoal::kEnabled);
  ASSERT_EQ(rig.robot.drives().fault, Fault::kDriveSilent);
  rig.cycles(20, DriveGoal::kQuickStop);
  ASSERT_EQ(rig.robot.drive(0).state, DriveState::kQuickStopActive);
  EXPECT_TRUE(rig.robot.isHolding(0));
  EXPECT_TRUE(rig.robot.drives().is_any_holding);
  EXPECT_FALSE(rig.robot.drives().are_disabled);
  rig.cycles(150, DriveGoal::kQuickStop);
  EXPECT_FALSE(rig.robot.drives().is_any_holding);
  EXPECT_TRUE(rig.robot.drives().are_disabled);
}

/// A bus may send in every other cycle, as where an echo takes more than one.
TEST(CanRobot, SaysThatItRunsHoweverOftenABusIsHeldBack) {
  for (const int held_back : {1, 2, 3}) {
    RobotRig rig;
    const CanFrame heartbeat =
        heartbeatFrame(CanopenConfig{}.master_node_id, NmtState::kOperational);
    int silent = 0, most_silent = 0;
    for (int i = 0; i < 2000; ++i) {
      if (i % 500 == 499) rig.robot.coast(1);
      rig.robot.command(DriveGoal::kSilent, false, JointVector::Zero(2));
      rig.robot.write(JointVector::Zero(2));
      const std::span<const CanFrame> frames = rig.robot.outbox(0).frames();
      const bool is_sent = i % (1 + held_back) == 0;
      if (!is_sent) rig.robot.noteHeldBack(0);
      const bool has_heartbeat = std::ranges::find(frames, heartbeat) != frames.end();
      silent = is_sent && has_heartbeat ? 0 : silent + 1;
      most_silent = std::max(most_silent, silent);
    }
    EXPECT_LE(most_silent, 20 + held_back) << held_back;
  }
}

TEST(CanRobot, IsHeldByADriveThatSlowsDown) {
  RobotRig rig;
  rig.enable();
  rig.slaves[0].quick_stop_cycles = 100;
  rig.slaves[1].fault(0x7500);
  rig.cycles(3, DriveGoal::kQuickStop);
  ASSERT_EQ(rig.robot.drive(0).state, DriveState::kQuickStopActive);
  ASSERT_EQ(rig.robot.drive(1).state, DriveState::kFaultReactionActive);
  EXPECT_TRUE(rig.robot.isHolding(0));
  EXPECT_TRUE(rig.robot.isHolding(1));
  rig.cycles(10, DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.robot.isHolding(0));
  EXPECT_FALSE(rig.robot.isHolding(1)) << "in fault it has no torque";
}

TEST(CanRobot, SeesEachOfItsDrivesThatMovesOn) {
  for (const int moving : {0, 1}) {
    RobotRig rig;
    rig.enable();
    for (int i = 0; i < 110; ++i) {
      rig.slaves[moving].position += 1000;  // 1 rad/s
      rig.cycle(DriveGoal::kQuickStop);
    }
    EXPECT_TRUE(rig.robot.drives().is_any_moving_on) << moving;
    EXPECT_FALSE(rig.robot.drive(1 - moving).is_moving_on) << moving;
  }
}

/// Its drive's deadline passes in missed cycles, too; then only silence stops it, the other's, too.
TEST(CanRobot, FallsSilentForADriveThatDoesNotStop) {
  RobotRig rig;
  rig.enable();
  rig.slaves[0].ignores_commands = rig.slaves[0].ignores_nmt = true;
  rig.cycles(100, DriveGoal::kQuickStop);
  rig.robot.coast(300);
  rig.cycles(100, DriveGoal::kQuickStop);
  EXPECT_FALSE(rig.robot.drive(0).is_cut_off);
  rig.cycle(DriveGoal::kQuickStop);
  EXPECT_TRUE(rig.robot.drive(0).is_cut_off);
  EXPECT_FALSE(rig.robot.outbox(0).empty());
  rig.cycles(Drive::kCuttingOffCycles, DriveGoal::kQuickStop);
  for (int i = 0; i < 50; ++i) {
    rig.cycle(DriveGoal::kQuickStop);
    EXPECT_TRUE(rig.robot.outbox(0).empty()) << i;
  }
}

TEST(CanRobot, ForgetsTheFaultsOfItsDrivesByARestartAlone) {
  RobotRig rig;
  rig.enable();
  rig.slaves[0].fault(0x7500);
  rig.cycles(20, DriveGoal::kQuickStop);
  rig.cycles(200, DriveGoal::kConfigure);
  EXPECT_EQ(rig.robot.drives().fault, Fault::kDriveFault);
  rig.enable();
  EXPECT_EQ(rig.robot.drives().fault, Fault::kNone);
  EXPECT_TRUE(rig.robot.drives().are_enabled);
}

/// With a tracking gain, enabled at `start`.
struct TrackedRig : RobotRig {
  TrackedRig() : RobotRig(tracked()) {
    enable();
    RobotInput input;
    robot.read(input);
    start = input.q_measured;
  }

  static HardwareConfig tracked() {
    HardwareConfig config = hardware();
    for (DriveConfig& drive : config.drives) drive.tracking_gain_per_s = 10.0;
    return config;
  }

  JointVector start;
  JointVector apart = (JointVector(2) << 0.01, -0.02).finished();  ///< further on
};

TEST(CanRobot, PullsItsDrivesToWhereTheyAreCommandedToBe) {
  TrackedRig rig;
  rig.robot.command(DriveGoal::kEnabled, false, rig.start + rig.apart);
  rig.write(JointVector::Zero(2));
  for (const int joint : {0, 1})
    EXPECT_NEAR(rig.slaves[joint].velocity, 10.0 * rig.apart[joint] * 1e6, 1.0) << joint;
}

/// Which no place between the last two hides.
TEST(CanRobot, RefusesAPlaceThatIsNaN) {
  TrackedRig rig;
  rig.robot.command(DriveGoal::kEnabled, false, rig.start + rig.apart);
  const JointVector q{{std::nan(""), rig.start[1]}};
  rig.robot.command(DriveGoal::kEnabled, false, q);
  rig.write(JointVector::Zero(2));
  EXPECT_EQ(rig.robot.drive(0).fault, Fault::kCommandNotFinite);
  EXPECT_EQ(rig.robot.drive(1).fault, Fault::kNone);
  EXPECT_EQ(rig.slaves[0].velocity, 0);
}

/// What they tell after a pause, and a cycle later, may be of its begin: no lag, though they are
/// commanded further on.
TEST(CanRobot, PullsNoDriveForTheWayOfMissedCycles) {
  TrackedRig rig;
  const auto cycle = [&](const JointVector& q) {
    RobotInput input;
    rig.robot.expect(q);
    rig.robot.read(input);
    rig.robot.command(DriveGoal::kEnabled, false, q);
    rig.write(JointVector::Constant(2, 0.1));
  };
  cycle(rig.start);
  rig.robot.coast(20);
  for (int i = 0; i < 2; ++i) {
    cycle(rig.start + rig.apart);
    for (const int joint : {0, 1}) EXPECT_NEAR(rig.slaves[joint].velocity, 0.1e6, 1.0) << joint;
  }
  cycle(rig.start + rig.apart);
  for (const int joint : {0, 1})
    EXPECT_NEAR(rig.slaves[joint].velocity, (0.1 + 10.0 * rig.apart[joint]) * 1e6, 1.0) << joint;
}

/// Of the same identifiers, each on its bus.
TEST(CanRobot, HearsItsTactileModules) {
  HardwareConfig hardware = RobotRig::hardware();
  hardware.buses.resize(2);
  for (const int bus : {0, 1}) {
    hardware.tactile_modules.push_back(test::tactileConfig());
    hardware.tactile_modules.back().bus = bus;
  }
  RobotRig rig(hardware);
  ASSERT_EQ(rig.robot.tactileModules().size(), 2u);
  RobotInput input;
  const auto hear = [&](int bus, int sequence, int count, std::uint8_t status = 0) {
    rig.robot.receive(bus, test::tactileFrames(sequence, {count}, status));
    rig.robot.read(input);
  };
  hear(0, 7, 1000);
  EXPECT_EQ(input.tactile[0].sequence, 1u);
  EXPECT_NEAR(input.tactile[0].force_y_N, 1.0, 1e-12);
  EXPECT_EQ(input.tactile[1].sequence, 0u);
  hear(1, 7, 2000);
  EXPECT_NEAR(input.tactile[0].force_y_N, 1.0, 1e-12);
  EXPECT_NEAR(input.tactile[1].force_y_N, 2.0, 1e-12);
  hear(0, 8, 5000, 0x02);  // its cable is broken
  EXPECT_EQ(input.tactile[0].sequence, 1u) << "as if it said nothing";
  EXPECT_NEAR(input.tactile[0].force_y_N, 1.0, 1e-12);
  hear(1, 7, 3000);
  EXPECT_NEAR(input.tactile[1].force_y_N, 2.0, 1e-12) << "its number was there";
  for (int cycle = 0; cycle < 2000; ++cycle) rig.robot.read(input);
  hear(1, 7, 3000);
  EXPECT_NEAR(input.tactile[1].force_y_N, 3.0, 1e-12) << "after a long silence any number is new";
}

}  // namespace
}  // namespace tactus
