#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/canopen/moteus_frames.h"

/// The daemon's cycle and an arm whose drives are moteus controllers, on CAN FD in virtual time.
namespace tactus {
namespace {

using test::VirtualRobotCell;
using MoteusKind = Trouble::Kind;

Scene moteusScene(bool has_enable_line = false) {
  Scene scene = test::shippedScene("robots/planar2_moteus");
  scene.hardware->canopen.boot_timeout_s = 0.5;
  if (!has_enable_line) return scene;
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  return scene;
}

struct MoteusCell : VirtualRobotCell {
  explicit MoteusCell(const Scene& scene = moteusScene()) : VirtualRobotCell(scene) {
    input.lines.enable = true;
  }

  void steps(int count) {
    for (int i = 0; i < count; ++i) step();
  }
  void play(MoteusKind kind, int node) {
    plant.play({{.kind = kind,
                 .from_s = 0.0,
                 .until_s = 1e6,
                 .bus = 0,
                 .id = static_cast<std::uint32_t>(node)}},
               t_ns);
  }
  double fastest() const {
    return std::max(std::abs(plant.moteus(0).velocity()), std::abs(plant.moteus(1).velocity()));
  }
  /// Where the arm ends after a fault: at rest, without torque, and it stays there.
  void expectRest(Fault fault, int joint) {
    for (int i = 0; i < 2000 && cycle.report().fault == Fault::kNone; ++i) step();
    EXPECT_EQ(cycle.report().fault, fault) << faultName(cycle.report().fault);
    EXPECT_EQ(cycle.report().joint, joint);
    steps(1000);
    EXPECT_EQ(fastest(), 0.0);
    EXPECT_TRUE(cycle.report().mode == Mode::kFault || cycle.report().mode == Mode::kOff);
  }
};

TEST(MoteusCycle, StartsMovesAndStops) {
  MoteusCell cell;
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 2000)) << faultName(cell.cycle.report().fault);
  const double start = cell.cycle.robot().drive(0).position;
  double fastest = 0.0, distance = 0.0;
  for (int i = 0; i < 5000; ++i) {
    cell.step();
    ASSERT_EQ(cell.cycle.report().mode, Mode::kRunning) << faultName(cell.cycle.report().fault);
    fastest = std::max(fastest, cell.fastest());
    distance = std::max(distance, std::abs(cell.cycle.robot().drive(0).position - start));
  }
  EXPECT_GT(fastest, 0.02);
  EXPECT_GT(distance, 0.02) << "the task is followed";
  EXPECT_EQ(cell.plant.counters().frames_refused, 0u);
  EXPECT_EQ(cell.plant.counters().stale_setpoints_applied, 0u);
  EXPECT_EQ(cell.cycle.robot().malformedFrames(), 0);
  cell.input.stop_requested = true;
  ASSERT_TRUE(cell.runUntil(Mode::kOff, 2000));
  EXPECT_TRUE(cell.areDrivesOff());
  EXPECT_EQ(cell.fastest(), 0.0);
}

/// The two joints have opposite signs and different zeros; both go where the simulation's go.
TEST(MoteusCycle, GoesWhereCanopenDrivesGo) {
  Scene canopen = moteusScene();
  for (DriveConfig& drive : canopen.hardware->drives) {
    drive.kind = DriveKind::kCia402;
    drive.counts_per_unit = 1e7;
  }
  MoteusCell moteus, other(canopen);
  ASSERT_TRUE(moteus.runUntil(Mode::kRunning, 2000));
  ASSERT_TRUE(other.runUntil(Mode::kRunning, 2000)) << faultName(other.cycle.report().fault);
  moteus.steps(5000);
  other.steps(5000);
  for (int joint = 0; joint < 2; ++joint)
    EXPECT_NEAR(moteus.cycle.robot().drive(joint).position,
                other.cycle.robot().drive(joint).position, 2e-3);
}

TEST(MoteusCycle, ADriveFaultBringsAllToRest) {
  MoteusCell cell;
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 2000));
  cell.steps(1500);
  cell.play(MoteusKind::kDriveFault, 2);
  cell.expectRest(Fault::kDriveFault, 1);
  EXPECT_EQ(cell.cycle.report().drive.emergency_code, 33) << "motor driver fault";
  EXPECT_EQ(cell.plant.powerState(0), PowerState::kSwitchOnDisabled);
}

TEST(MoteusCycle, ASilentDriveBringsAllToRest) {
  for (const bool is_deaf : {false, true}) {
    MoteusCell cell;
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 2000));
    cell.steps(1500);
    cell.on_frame = [](int, CanFrame& frame) {
      if (isMoteusReply(frame, 1)) frame.id = 0x7F00;
    };
    if (is_deaf) cell.on_send = [](int, CanFrame& frame) { return frame.id != moteusCommandId(1); };
    cell.expectRest(Fault::kDriveSilent, 0);
    if (is_deaf) {
      EXPECT_EQ(cell.plant.moteus(0).mode(), 11) << "its watchdog has stopped it";
    }
  }
}

TEST(MoteusCycle, AReplyThatIsNoNumberBringsAllToRest) {
  MoteusCell cell;
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 2000));
  cell.steps(1500);
  const double before = cell.cycle.robot().drive(1).position;
  cell.play(MoteusKind::kNonsenseStatus, 2);
  cell.expectRest(Fault::kDriveFault, 1);
  EXPECT_NEAR(cell.cycle.robot().drive(1).position, before, 1e-2) << "the last number stays";
  EXPECT_TRUE(cell.areDrivesOff());
}

TEST(MoteusCycle, ADriveThatObeysNoMoreIsLeftToItsWatchdog) {
  MoteusCell cell;
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 2000));
  cell.steps(2500);
  ASSERT_GT(std::abs(cell.plant.moteus(0).velocity()), 0.004);
  cell.play(MoteusKind::kIgnoreCommands, 1);
  cell.input.lines.emergency_stop = true;
  cell.steps(1500);
  EXPECT_EQ(cell.fastest(), 0.0);
  EXPECT_EQ(cell.plant.moteus(0).mode(), 11);
  EXPECT_EQ(cell.plant.powerState(1), PowerState::kSwitchOnDisabled);
}

TEST(MoteusCycle, AWatchdogThatExpiredIsNoticed) {
  MoteusCell cell;
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 2000));
  cell.steps(1500);
  cell.on_frame = [](int, CanFrame& frame) {
    if (isMoteusReply(frame, 1)) frame.data[2] = 11;  // its mode
  };
  cell.expectRest(Fault::kDriveStateLost, 0);
}

TEST(MoteusCycle, ADriveThatDoesNotFollowIsNoticed) {
  MoteusCell cell;
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 2000));
  cell.steps(1500);
  cell.play(MoteusKind::kFreezeFeedback, 1);
  cell.expectRest(Fault::kFollowingError, 0);
}

TEST(MoteusCycle, IsCleared) {
  MoteusCell cell(moteusScene(true));
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 2000));
  cell.steps(1500);
  cell.play(MoteusKind::kDriveFault, 1);
  cell.expectRest(Fault::kDriveFault, 0);
  cell.plant.play({}, cell.t_ns);
  cell.switchEnable();
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 3000)) << faultName(cell.cycle.report().fault);
}

/// What the drives answered to the last setpoint is read after the pause: no following error,
/// though the arm was to be elsewhere by then. Their watchdogs stop them in a long one.
TEST(MoteusCycle, GoesOnAfterAPause) {
  MoteusCell running(moteusScene(true));
  ASSERT_TRUE(running.runUntil(Mode::kRunning, 2000));
  for (const int at : {500, 1500, 2500, 4000}) {
    while (running.cycle.taskCycles() < at) running.step();
    for (const int missed : {2, 15, 60, 150, 500, 1000, 5000, 100'000}) {
      SCOPED_TRACE(std::to_string(missed) + " at " + std::to_string(at));
      MoteusCell cell = running;
      cell.pause(missed);
      cell.steps(1000);
      EXPECT_EQ(cell.cycle.report().fault, missed < 3 ? Fault::kNone : Fault::kOverrun)
          << faultName(cell.cycle.report().fault);
      if (missed >= 3) cell.switchEnable();
      ASSERT_TRUE(cell.runUntil(Mode::kRunning, 3000)) << faultName(cell.cycle.report().fault);
      cell.steps(1000);
      EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning) << faultName(cell.cycle.report().fault);
    }
  }
}

/// On a longer and faster way, until a joint is fast.
MoteusCell fastCell(double tracking_gain_per_s = 0.0) {
  Scene scene = test::shippedScene("robots/planar2_moteus",
                                   {{"task.trajectory.line.speed_m_per_s", "0.3"},
                                    {"task.trajectory.line.displacement_m", "[-0.4, 0, 0]"}});
  for (DriveConfig& drive : scene.hardware->drives) drive.tracking_gain_per_s = tracking_gain_per_s;
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  MoteusCell cell(scene);
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 2000));
  for (int i = 0; i < 5000 && cell.fastest() < 0.45; ++i) cell.step();
  EXPECT_GE(cell.fastest(), 0.45) << "rad/s";
  return cell;
}

/// Drives stop further on than the tolerance of a start.
TEST(MoteusCycle, GoesOnAfterAPauseInAFastMotion) {
  const MoteusCell running = fastCell();
  for (const int missed : {150, 800, 5000}) {
    SCOPED_TRACE(missed);
    MoteusCell cell = running;
    cell.pause(missed);
    cell.steps(1000);
    EXPECT_EQ(cell.cycle.report().fault, Fault::kOverrun);
    cell.switchEnable();
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 3000)) << faultName(cell.cycle.report().fault);
  }
}

/// Through an adapter that hands on each reply a cycle late.
TEST(MoteusCycle, GoesOnAfterAPauseWhereRepliesAreLate) {
  for (const int missed : {5, 20, 50, 150, 800, 5000}) {
    SCOPED_TRACE(missed);
    MoteusCell cell = fastCell();
    std::array<CanFrame, 2> late;
    bool is_first = true;
    cell.on_frame = [&](int, CanFrame& frame) {
      for (int node = 1; node <= 2; ++node) {
        if (!isMoteusReply(frame, node)) continue;
        CanFrame& before = late[static_cast<std::size_t>(node - 1)];
        if (is_first) before = frame;
        std::swap(before, frame);
      }
    };
    cell.step();
    is_first = false;
    cell.steps(10);
    ASSERT_EQ(cell.cycle.report().mode, Mode::kRunning);
    cell.pause(missed);
    cell.steps(1000);
    EXPECT_EQ(cell.cycle.report().fault, Fault::kOverrun);
    cell.switchEnable();
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 3000)) << faultName(cell.cycle.report().fault);
  }
}

/// Their replies are of before the pause: that is no lag, to be made up for while the arm stops.
TEST(MoteusCycle, IsNoFasterAfterAPauseWhereDrivesAreTracked) {
  const MoteusCell running = fastCell(100.0);
  for (const int missed : {3, 10, 50}) {
    SCOPED_TRACE(missed);
    MoteusCell cell = running;
    const double before = cell.fastest();
    cell.pause(missed);
    EXPECT_EQ(cell.cycle.report().mode, Mode::kStopping);
    for (int i = 0; i < 10; ++i) {
      cell.step();
      EXPECT_LT(cell.fastest(), 1.02 * before) << i;
    }
  }
}

/// One that the adapter still tries to send when the bus has power again.
TEST(MoteusCycle, FollowsASetpointThatWaitedForPowerNoLongerThanItsWatchdog) {
  MoteusCell cell = fastCell();
  const double before = cell.fastest();
  cell.play(MoteusKind::kPowerCut, 0);
  cell.steps(1500);
  EXPECT_EQ(cell.cycle.report().fault, Fault::kBusUnacknowledged);
  EXPECT_EQ(cell.fastest(), 0.0);
  cell.plant.play({}, cell.t_ns);
  int moving_ms = 0;
  for (int i = 0; i < 1000; ++i) {
    cell.step();
    EXPECT_LE(cell.fastest(), 1.05 * before) << i;
    moving_ms += cell.fastest() > 0.0 ? 1 : 0;
  }
  const double stop_ms = 1e3 * before / MoteusSlave::kDeceleration;
  EXPECT_GT(moving_ms, 0) << "the hazard is there";
  EXPECT_LE(moving_ms, 60 + stop_ms + 2) << "heartbeat_timeout_s, and what it takes to slow down";
  EXPECT_EQ(cell.cycle.report().mode, Mode::kFault);
  EXPECT_EQ(cell.fastest(), 0.0);
}

struct WrongStart {
  const char* what;
  std::function<void(CanFrame&)> change;  ///< of a reply of node 2 in the set-up
  std::uint16_t blamed;
};

TEST(MoteusCycle, StartsWithNothingElse) {
  const std::vector<WrongStart> starts = {
      {"silent", [](CanFrame& frame) { frame.id = 0x7F00; }, moteus_register::kPosition},
      {"another map", [](CanFrame& frame) { frame.data[22] = 4; }, moteus_register::kMapVersion},
      {"known by its rotor alone", [](CanFrame& frame) { frame.data[18] = 1; },
       moteus_register::kHome},
      {"in fault", [](CanFrame& frame) { frame.data[2] = 1, frame.data[15] = 35; },
       moteus_register::kFault},
      {"enabled", [](CanFrame& frame) { frame.data[2] = 10; }, moteus_register::kMode},
      {"nowhere", [](CanFrame& frame) { frame.data[8] = 0x7F, frame.data[7] = 0xC0; },
       moteus_register::kPosition}};
  for (const WrongStart& start : starts) {
    SCOPED_TRACE(start.what);
    MoteusCell cell;
    cell.on_frame = [&](int, CanFrame& frame) {
      if (isMoteusReply(frame, 2)) start.change(frame);
    };
    for (int i = 0; i < 3000 && cell.cycle.report().fault == Fault::kNone; ++i) {
      cell.step();
      EXPECT_NE(cell.plant.powerState(0), PowerState::kOperationEnabled);
    }
    EXPECT_EQ(cell.cycle.report().fault, Fault::kDriveSetupRefused);
    EXPECT_EQ(cell.cycle.robot().drive(1).setup_failure.index, start.blamed);
  }
}

}  // namespace
}  // namespace tactus
