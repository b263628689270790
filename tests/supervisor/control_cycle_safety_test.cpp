#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/supervisor/control_cycle.h"

/// What could hurt somebody: brakes at the wrong time, an arm that starts from elsewhere or blind,
/// drives that are taken for off.
namespace tactus {
namespace {

using test::shippedScene;
using test::VirtualRobotCell;

constexpr int kBrakeCycles = 150;
constexpr int kDeadlineCycles = 500;  // the default of stop_deadline_s

Scene withBrakeAndEnable() {
  Scene scene = shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->brake.emplace();
  scene.hardware->gpio->enable.emplace();
  scene.hardware->gpio->brake_switching_s = 1e-3 * kBrakeCycles;
  return scene;
}

bool isAnyDriveOff(const VirtualRobotCell& cell) {
  for (int joint = 0; joint < 9; ++joint) {
    if (cell.plant.drive(joint).powerState() != PowerState::kOperationEnabled) return true;
  }
  return false;
}

/// Cycles between the brake's line falling and the first drive that lets go.
int holdWhileBrakesClose(VirtualRobotCell& cell) {
  int falls = -1;
  for (int i = 0; i < 5000; ++i) {
    cell.step();
    if (falls < 0 && !cell.cycle.lines().release_brake) falls = i;
    if (isAnyDriveOff(cell)) return falls < 0 ? -1 : i - falls;
  }
  return -1;
}

TEST(ControlCycleSafety, DrivesHoldWhileBrakesCloseAfterAHold) {
  VirtualRobotCell cell(withBrakeAndEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 1000; ++i) cell.step();
  cell.input.lines.enable = false;
  for (int i = 0; i < 1000; ++i) cell.step();
  ASSERT_EQ(cell.cycle.report().mode, Mode::kHolding);
  ASSERT_TRUE(cell.cycle.lines().release_brake);
  cell.input.stop_requested = true;
  EXPECT_GE(holdWhileBrakesClose(cell), kBrakeCycles);
}

TEST(ControlCycleSafety, DrivesHoldWhileBrakesCloseAfterAnEnablingCutShort) {
  VirtualRobotCell cell(withBrakeAndEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kEnabling, 5000));
  for (int i = 0; i < 2000 && !cell.cycle.lines().release_brake; ++i) cell.step();
  ASSERT_EQ(cell.cycle.report().mode, Mode::kEnabling);
  for (int i = 0; i < 5; ++i) cell.step();
  cell.input.lines.enable = false;
  EXPECT_GE(holdWhileBrakesClose(cell), kBrakeCycles);
}

TEST(ControlCycleSafety, AFaultNeverOpensABrake) {
  VirtualRobotCell cell(withBrakeAndEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  cell.input.stop_requested = true;
  for (int i = 0; i < 1000 && cell.cycle.lines().release_brake; ++i) cell.step();
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 0 && frame.id == 0x181) frame.data[0] = 0x37;  // a drive that stays enabled
  };
  bool has_faulted = false;
  for (int i = 0; i < 8000 && !cell.cycle.isFinished(); ++i) {
    cell.step();
    ASSERT_FALSE(cell.cycle.lines().release_brake) << i;
    has_faulted |= cell.cycle.report().mode == Mode::kFault;
  }
  EXPECT_TRUE(has_faulted);
  EXPECT_TRUE(cell.cycle.isFinished());
  EXPECT_EQ(cell.cycle.report().fault, Fault::kDriveStateLost);  // no clean end
}

/// In fault for a while: drives that are not seen off hold up the end until they are cut off.
void expectFaultUntilCutOff(VirtualRobotCell& cell) {
  for (int i = 0; i < kDeadlineCycles - 20; ++i) {
    cell.step();
    ASSERT_EQ(cell.cycle.report().mode, Mode::kFault) << i;
  }
  EXPECT_TRUE(cell.runUntil(Mode::kOff, 100));
}

TEST(ControlCycleSafety, AnUnknownStatusWordIsNoDriveThatIsOff) {
  VirtualRobotCell cell(withBrakeAndEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 100; ++i) cell.step();
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 0 && frame.id == 0x181) frame.data[0] = 0x67;
  };
  cell.input.lines.emergency_stop = true;
  for (int i = 0; i < 10; ++i) cell.step();
  cell.input.stop_requested = true;
  expectFaultUntilCutOff(cell);
}

/// Switched on is power without torque: not off, and nothing that a brake should wait for.
TEST(ControlCycleSafety, DrivesThatStaySwitchedOnAreNotOffAndHoldNoBrakeOpen) {
  VirtualRobotCell cell(withBrakeAndEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 100; ++i) cell.step();
  cell.on_frame = [](int bus, CanFrame& frame) {
    const bool is_feedback = bus < 3 && frame.id > 0x180 && frame.id < 0x190;
    if (is_feedback) frame.data[0] = 0x33;
  };
  for (int i = 0; i < 10; ++i) cell.step();
  ASSERT_EQ(cell.cycle.report().mode, Mode::kFault);
  EXPECT_FALSE(cell.cycle.lines().release_brake);
  cell.input.stop_requested = true;
  expectFaultUntilCutOff(cell);
}

/// As if somebody had pushed joint 4 on bus 1, while drives were off: 1e6 counts a rad.
void pushAway(VirtualRobotCell& cell, int counts) {
  cell.on_frame = [counts](int bus, CanFrame& frame) {
    if (bus != 1 || frame.id != 0x182) return;
    std::int32_t position = 0;
    std::memcpy(&position, frame.data.data() + 2, sizeof(position));
    position += counts;
    std::memcpy(frame.data.data() + 2, &position, sizeof(position));
  };
}

TEST(ControlCycleSafety, AnArmThatWasPushedAwayDoesNotStartAgain) {
  VirtualRobotCell cell(withBrakeAndEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 2000; ++i) cell.step();
  cell.input.lines.emergency_stop = true;
  for (int i = 0; i < 500; ++i) cell.step();
  ASSERT_TRUE(cell.areDrivesOff());
  pushAway(cell, 1'000'000);
  cell.input.lines.emergency_stop = false;
  cell.switchEnable();
  for (int i = 0; i < 4000; ++i) {
    cell.step();
    ASSERT_EQ(cell.largestSetpoint(), 0) << i;
    ASSERT_NE(cell.cycle.report().mode, Mode::kEnabling) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart);
  cell.on_frame = nullptr;  // and is put back
  cell.switchEnable();
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 4000)) << faultName(cell.cycle.report().fault);
}

TEST(ControlCycleSafety, AnArmThatIsPushedAwayWhileItWaitsDoesNotStart) {
  VirtualRobotCell cell(withBrakeAndEnable());
  cell.input.lines.enable = false;
  ASSERT_TRUE(cell.runUntil(Mode::kReady, 5000));
  pushAway(cell, -1'000'000);
  cell.step();
  cell.input.lines.enable = true;
  for (int i = 0; i < 3000; ++i) {
    cell.step();
    ASSERT_EQ(cell.largestSetpoint(), 0) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart);
}

/// Nor does it once its drives are being switched on.
TEST(ControlCycleSafety, AnArmThatIsPushedAwayWhileItIsEnabledDoesNotStart) {
  VirtualRobotCell cell(withBrakeAndEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kEnabling, 5000));
  pushAway(cell, -1'000'000);
  for (int i = 0; i < 3000; ++i) {
    cell.step();
    ASSERT_NE(cell.cycle.report().mode, Mode::kRunning) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart) << faultName(cell.cycle.report().fault);
}

/// A limp joint is pushed slowly while the enable line flickers. Each attempt finds it hardly
/// farther than the one before, but none of them ever held it.
TEST(ControlCycleSafety, AnArmThatCreepsThroughStartsThatAreBrokenOffDoesNotStart) {
  VirtualRobotCell cell(withBrakeAndEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 1000; ++i) cell.step();
  cell.input.lines.emergency_stop = true;
  for (int i = 0; i < 500; ++i) cell.step();
  cell.input.lines.emergency_stop = false;
  cell.switchEnable();
  cell.step();
  cell.input.lines.enable = false;
  ASSERT_TRUE(cell.runUntil(Mode::kReady, 4000));
  for (int i = 0; i < 200; ++i) {
    pushAway(cell, 1000 * i);
    cell.input.lines.enable = i % 4 < 2;
    cell.step();
  }
  for (int i = 0; i < 2000; ++i) {
    cell.input.lines.enable = i >= 100;
    cell.step();
    ASSERT_EQ(cell.largestSetpoint(), 0) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart) << faultName(cell.cycle.report().fault);
}

TEST(ControlCycleSafety, NeverStartsBlind) {
  const auto mute = [](int bus, CanFrame& frame) {
    if (bus == 3) frame.id = 0x7FF;
  };
  VirtualRobotCell cell(withBrakeAndEnable());
  cell.input.lines.enable = false;
  ASSERT_TRUE(cell.runUntil(Mode::kReady, 5000));
  cell.on_frame = mute;
  for (int i = 0; i < 100; ++i) cell.step();
  cell.input.lines.enable = true;
  for (int i = 0; i < 3000; ++i) {
    cell.step();
    ASSERT_EQ(cell.largestSetpoint(), 0) << i;
    ASSERT_NE(cell.cycle.report().mode, Mode::kEnabling) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kTactileStale);
  cell.on_frame = nullptr;
  cell.switchEnable();
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 4000)) << faultName(cell.cycle.report().fault);
}

TEST(ControlCycleSafety, NeverStartsOnAReadingThatWouldStopIt) {
  VirtualRobotCell cell(withBrakeAndEnable());
  cell.input.lines.enable = false;
  ASSERT_TRUE(cell.runUntil(Mode::kReady, 5000));
  cell.on_frame = [](int bus, CanFrame& frame) {  // 80 N on each of two cells of one side
    if (bus == 3 && (frame.id == 0x100 || frame.id == 0x102)) {
      frame.data[2] = 0x00;
      frame.data[3] = 0x12;
      frame.data[4] = 0x7A;
    }
  };
  for (int i = 0; i < 100; ++i) cell.step();
  cell.input.lines.enable = true;
  for (int i = 0; i < 1000; ++i) {
    cell.step();
    ASSERT_NE(cell.cycle.report().mode, Mode::kRunning) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kTactileInvalid);
  cell.on_frame = nullptr;
  cell.switchEnable();
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 4000)) << faultName(cell.cycle.report().fault);
}

TEST(ControlCycleSafety, ARefusedTareIsRepeatedByTheEnableLine) {
  VirtualRobotCell cell(withBrakeAndEnable());
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3 && frame.id == 0x100) frame.data[4] = 5;  // a hand on the cover
  };
  ASSERT_TRUE(cell.runUntil(Mode::kFault, 5000));
  EXPECT_EQ(cell.cycle.report().fault, Fault::kTareRefused);
  cell.on_frame = nullptr;
  for (int i = 0; i < 1000; ++i) {
    cell.step();
    ASSERT_EQ(cell.cycle.robot().tactileModules()[0].tareState(), TareState::kRefused) << i;
  }
  cell.switchEnable();
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000)) << faultName(cell.cycle.report().fault);
}

TEST(ControlCycleSafety, AForbiddenCallHidesNoHarsherFault) {
  VirtualRobotCell cell(withBrakeAndEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 1000; ++i) cell.step();
  cell.input.has_forbidden_call = true;
  cell.step();
  ASSERT_EQ(cell.cycle.report().mode, Mode::kStopping);
  cell.on_bus = [](int bus, BusMonitor& monitor) {
    if (bus == 1) monitor.onSendError(ENETDOWN);
  };
  cell.step();
  EXPECT_EQ(cell.cycle.report().mode, Mode::kFault);
}

/// Lost, late, swapped, spoilt and doubled frames of every id on every bus, while the arm moves.
TEST(ControlCycleSafety, TroubledFramesNeverLeadBeyondTheLimits) {
  using Kind = Trouble::Kind;
  for (const Kind kind :
       {Kind::kDrop, Kind::kDelay, Kind::kReorder, Kind::kCorrupt, Kind::kDuplicate}) {
    for (int bus = 0; bus < 4; ++bus) {
      SCOPED_TRACE(std::to_string(static_cast<int>(kind)) + " on bus " + std::to_string(bus));
      Scene scene = shippedScene("scenario1_multi_space");
      Trouble trouble;
      trouble.kind = kind;
      trouble.from_s = 4.0;
      trouble.until_s = 4.0 + (bus % 2 == 0 ? 0.003 : 1.0);
      trouble.bus = bus;
      trouble.delay_s = 0.0035;
      scene.troubles = {trouble};
      VirtualRobotCell cell(scene);
      ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
      const JointVector& limit = scene.controller.limits.max_velocity;
      for (int i = 0; i < 5500 && !cell.cycle.isFinished(); ++i) {
        cell.step();
        for (int b = 0; b < 3; ++b) {
          for (const CanFrame& frame : cell.cycle.outbox(b)) {
            if (frame.id <= 0x200 || frame.id >= 0x280) continue;
            const int joint = 3 * b + static_cast<int>(frame.id) - 0x201;
            const double counts = limit[joint] * scene.hardware->drives[joint].counts_per_unit;
            ASSERT_LE(std::abs(VirtualRobotCell::velocityCounts(frame)), counts + 1.0);
          }
        }
      }
      const ModeReport report = cell.cycle.report();
      if (report.mode == Mode::kRunning) continue;
      EXPECT_NE(report.fault, Fault::kNone);
      EXPECT_TRUE(cell.cycle.isFinished()) << modeName(report.mode);
      EXPECT_EQ(cell.largestSetpoint(), 0);
    }
  }
}

}  // namespace
}  // namespace tactus
