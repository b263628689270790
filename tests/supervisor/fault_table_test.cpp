#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// Every fault of the table, injected while the arm moves in contact: how long it takes until the
/// set-points are zero and the drives are off, and how the arm starts again.
namespace tactus {
namespace {

using test::VirtualRobotCell;

constexpr int kContactCycles = 7000;  // of scenario 1: pressing the band aside

struct Injection {
  Fault fault;
  std::function<void(VirtualRobotCell&)> inject;
  int max_detection_cycles;  ///< until the mode changes
};

/// Changes frames of one id on their way to the daemon.
std::function<void(VirtualRobotCell&)> changeFrames(int bus, std::uint32_t id,
                                                    std::function<void(CanFrame&)> change) {
  return [=](VirtualRobotCell& cell) {
    cell.on_frame = [=](int at, CanFrame& frame) {
      if (at == bus && frame.id == id && frame.kind == FrameKind::kData) change(frame);
    };
  };
}

std::function<void(VirtualRobotCell&)> changeInput(std::function<void(CycleInput&)> change) {
  return [=](VirtualRobotCell& cell) { change(cell.input); };
}

std::function<void(VirtualRobotCell&)> changeBus(std::function<void(BusMonitor&)> change) {
  return [=](VirtualRobotCell& cell) {
    cell.on_bus = [=](int bus, BusMonitor& monitor) {
      if (bus == 1) change(monitor);
    };
  };
}

CanFrame errorFrame(std::uint32_t error_class, std::uint8_t controller_state = 0) {
  CanFrame frame;
  frame.kind = FrameKind::kError;
  frame.id = error_class;
  frame.size = 8;
  frame.data[1] = controller_state;
  return frame;
}

/// Bytes 2..4 hold the first of a frame's two channels of the module.
void setChannel(CanFrame& frame, std::int32_t counts) {
  for (int i = 0; i < 3; ++i) frame.data[2 + i] = static_cast<std::uint8_t>(counts >> (8 * i));
}

/// 80 N on each of two cells that face the same way.
void pushHard(VirtualRobotCell& cell) {
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3 && (frame.id == 0x100 || frame.id == 0x102)) setChannel(frame, 8'000'000);
  };
}

/// What the robot can do to the daemon while it runs; the rest comes only while booting.
std::vector<Injection> injections() {
  using enum Fault;
  const auto vanish = [](CanFrame& frame) { frame.id = 0x7FF; };
  return {
      {kTactileInvalid, pushHard, 6},
      {kTactileStale, changeFrames(3, 0x102, vanish), 26},
      {kTactileSaturated, changeFrames(3, 0x101, [](CanFrame& f) { setChannel(f, 0x7FFFFF); }), 6},
      {kTactileCableBreak, changeFrames(3, 0x103, [](CanFrame& f) { f.data[1] = 2; }), 6},
      {kBusStalled, changeBus([](BusMonitor& m) { m.onSent(0, 4); }), 6},
      {kBusUnacknowledged, changeBus([](BusMonitor& m) { m.onErrorFrame(errorFrame(0x24, 0x20)); }),
       1},
      {kBusOff, changeBus([](BusMonitor& m) { m.onErrorFrame(errorFrame(0x40)); }), 1},
      {kBusDown, changeBus([](BusMonitor& m) { m.onReceiveError(100); }), 1},  // ENETDOWN
      {kBusFlooded, changeBus([](BusMonitor& m) {
         for (int i = 0; i < 3; ++i) m.onReceived(64, true);
       }),
       1},
      {kDriveSilent, changeFrames(1, 0x182, vanish), 6},
      {kDriveFault, changeFrames(1, 0x182, [](CanFrame& f) { f.data[0] = 0x08; }), 1},
      {kDriveStateLost, changeFrames(1, 0x182, [](CanFrame& f) { f.data[0] = 0x40; }), 1},
      {kFollowingError, changeFrames(1, 0x182, [](CanFrame& f) { f.data[4] ^= 0x10; }), 1},
      {kEmergencyStop, changeInput([](CycleInput& i) { i.lines.emergency_stop = true; }), 1},
      {kGpioLost, changeInput([](CycleInput& i) { i.are_lines_lost = true; }), 1},
      {kOverrun, changeInput([](CycleInput& i) { i.late_in_a_row = 4; }), 1},
      {kForbiddenSystemCall, changeInput([](CycleInput& i) { i.has_forbidden_call = true; }), 1},
  };
}

Scene movingInContact(bool has_enable_line) {
  Scene scene = test::shippedScene("scenario1_multi_space");
  scene.hardware->gpio.emplace();
  if (has_enable_line) scene.hardware->gpio->enable.emplace();
  return scene;
}

void moveInContact(VirtualRobotCell& cell) {
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < kContactCycles; ++i) cell.step();
  ASSERT_EQ(cell.cycle.report().mode, Mode::kRunning);
  ASSERT_GT(cell.record().force_sensor_N[0], 1.0);
  ASSERT_GT(cell.largestSetpoint(), 0);
}

void clearInjection(VirtualRobotCell& cell) {
  cell.on_frame = nullptr;
  cell.on_bus = nullptr;
  cell.input = {};
}

/// Cycles from the first one that could see the trouble.
struct Reacted {
  int detected = 0, zero = 0, off = 0;
};

/// For drives whose quick stop is slow: theirs to set.
constexpr int kStoppingCycles = 250;

/// Out of a contact of some newtons, or until a reading that does not answer is not believed.
constexpr int kRetreatCycles = 500;

/// What drives do on their own does not count: set-points of the daemon, power of all drives.
Reacted inject(VirtualRobotCell& cell, const Injection& injection, int cycles) {
  Reacted reacted;
  const double acceleration_counts = 200.0 * 0.001 * 1e7;
  int before = cell.largestSetpoint();
  injection.inject(cell);
  for (int i = 1; i <= cycles; ++i) {
    cell.step();
    const int setpoint = cell.largestSetpoint();
    const bool is_detected = cell.cycle.report().fault != Fault::kNone;
    if (is_detected && reacted.detected == 0) reacted.detected = i;
    if (is_detected) {
      EXPECT_LE(setpoint, before + acceleration_counts);
    }
    if (setpoint != 0) reacted.zero = i + 1;
    if (!cell.areDrivesOff()) reacted.off = i + 1;
    before = setpoint;
  }
  return reacted;
}

/// Runs `check` for every injection, each with an arm that moves in contact.
void forEachFault(bool has_enable_line,
                  const std::function<void(VirtualRobotCell&, const Injection&)>& check) {
  VirtualRobotCell moving(movingInContact(has_enable_line));
  moveInContact(moving);
  for (const Injection& injection : injections()) {
    SCOPED_TRACE(faultName(injection.fault));
    VirtualRobotCell cell = moving;
    check(cell, injection);
  }
}

TEST(FaultInContact, BringsTheArmToRestAndEnds) {
  forEachFault(false, [](VirtualRobotCell& cell, const Injection& injection) {
    const FaultRow& row = faultRow(injection.fault);
    const Reacted reacted = inject(cell, injection, 900);
    std::printf("%-22s %-20s detected %2d, setpoints zero %2d, drives off %3d cycles\n", row.name,
                reactionName(row.reaction), reacted.detected, reacted.zero, reacted.off);
    EXPECT_EQ(cell.cycle.report().fault, injection.fault) << faultName(cell.cycle.report().fault);
    EXPECT_GE(reacted.detected, 1);
    EXPECT_LE(reacted.detected, injection.max_detection_cycles);
    const int ramp_cycles = row.reaction >= Reaction::kQuickStop ? 0 : 10;
    const int way_out_cycles = row.reaction == Reaction::kRetreat ? kRetreatCycles : 0;
    EXPECT_LE(reacted.zero, reacted.detected + way_out_cycles + ramp_cycles);
    EXPECT_LE(reacted.off, reacted.detected + way_out_cycles + kStoppingCycles);
    EXPECT_TRUE(cell.cycle.isFinished());
    EXPECT_FALSE(cell.cycle.lines().release_brake);
  });
}

TEST(FaultInContact, RestartsByTheEnableLineOnly) {
  forEachFault(true, [](VirtualRobotCell& cell, const Injection& injection) {
    inject(cell, injection, 900);
    const Mode rest =
        faultRow(injection.fault).reaction == Reaction::kRetreat ? Mode::kHolding : Mode::kFault;
    EXPECT_EQ(cell.cycle.report().mode, rest);
    clearInjection(cell);
    for (int i = 0; i < 500; ++i) cell.step();
    EXPECT_EQ(cell.cycle.report().mode, rest) << "the enable line was not switched off and on";
    EXPECT_EQ(cell.largestSetpoint(), 0);
    cell.switchEnable();
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 3000))
        << modeName(cell.cycle.report().mode) << " " << faultName(cell.cycle.report().fault);
    for (int i = 0; i < 1000; ++i) cell.step();
    EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
    EXPECT_EQ(cell.plant.counters().stale_setpoints_applied, 0u);
  });
}

TEST(FaultInContact, DoesNotMoveWhileTheCauseIsThere) {
  forEachFault(true, [](VirtualRobotCell& cell, const Injection& injection) {
    if (injection.fault == Fault::kFollowingError) return;  // a jump is no lasting cause
    inject(cell, injection, 900);
    for (int i = 0; i < 2; ++i) {
      cell.switchEnable();
      for (int k = 0; k < 1000; ++k) {
        cell.step();
        ASSERT_EQ(cell.largestSetpoint(), 0) << k;
        ASSERT_NE(cell.cycle.report().mode, Mode::kRunning) << k;
      }
    }
  });
}

}  // namespace
}  // namespace tactus
