#include <gtest/gtest.h>

#include <cmath>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// The cycle's own time limits: how long each mode waits for what never comes.
namespace tactus {
namespace {

using test::VirtualRobotCell;

Scene bareScene() {
  return test::shippedScene("scenario1_null_space", {{"simulation.obstacles", "[]"}});
}

/// Cycles in a mode until there is a fault.
int cyclesUntilFault(VirtualRobotCell& cell, Mode mode) {
  int cycles = 0;
  for (int i = 0; i < 20000 && cell.cycle.report().fault == Fault::kNone; ++i) {
    cell.step();
    cycles += cell.cycle.report().mode == mode ? 1 : 0;
  }
  return cycles;
}

/// Two seconds, and the time of the brakes.
TEST(ControlCycleTimes, DrivesHaveTwoSecondsToSwitchOn) {
  for (const double brakes_s : {0.0, 0.15}) {
    Scene scene = bareScene();
    if (brakes_s > 0.0) {
      scene.hardware->gpio.emplace().brake.emplace();
      scene.hardware->gpio->brake_switching_s = brakes_s;
    }
    VirtualRobotCell cell(scene);
    cell.on_send = [](int, CanFrame& frame) { return frame.id < 0x200 || frame.id >= 0x280; };
    EXPECT_NEAR(cyclesUntilFault(cell, Mode::kEnabling) * scene.period_s, 2.0 + brakes_s, 0.003);
    EXPECT_EQ(cell.cycle.report().fault, Fault::kDriveStateLost);
  }
}

/// The drive of this joint is told to stay switched on where it shall switch off.
void holdPower(VirtualRobotCell& cell, int joint) {
  cell.on_send = [=](int bus, CanFrame& frame) {
    const bool is_of_joint =
        bus == joint / 3 && frame.id == 0x201U + static_cast<std::uint32_t>(joint % 3);
    if (is_of_joint && frame.data[0] == 0x02) frame.data[0] = 0x07;
    return true;
  };
}

/// As long as to switch on, beside the ramp and what drives have to switch off by themselves.
/// Cycles that were missed are a part of that.
TEST(ControlCycleTimes, DrivesHaveTwoSecondsMoreToSwitchOff) {
  for (const double brakes_s : {0.0, 0.15}) {
    for (const int missed : {0, 7}) {
      Scene scene = bareScene();
      scene.hardware->gpio.emplace().brake.emplace();
      scene.hardware->gpio->brake_switching_s = brakes_s;
      scene.controller.limits.max_acceleration.setConstant(10.0);
      VirtualRobotCell cell(scene);
      ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
      const int joint = missed > 0 ? 0 : 4;
      holdPower(cell, joint);
      cell.input.stop_requested = true;
      ASSERT_TRUE(cell.runUntil(Mode::kStopping, 1));
      cell.input.missed_cycles = missed;
      cell.step();
      cell.input.missed_cycles = 0;
      const int cycles = cyclesUntilFault(cell, Mode::kStopping) + missed;
      const double ramp_s = scene.controller.limits.max_velocity.maxCoeff() / 10.0;
      EXPECT_NEAR(cycles * scene.period_s,
                  2.0 + brakes_s + ramp_s + scene.hardware->canopen.stop_deadline_s, 0.004);
      EXPECT_EQ(cell.cycle.report().fault, Fault::kDriveStateLost);
      EXPECT_EQ(cell.cycle.report().joint, joint);
    }
  }
}

/// Whatever a scene says of its joints.
TEST(ControlCycleTimes, ARampHasHalfAMinuteAtMost) {
  Scene scene = bareScene();
  scene.controller.limits.max_acceleration = scene.controller.limits.max_velocity / 40.0;
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  holdPower(cell, 4);
  cell.input.stop_requested = true;
  ASSERT_TRUE(cell.runUntil(Mode::kStopping, 1));
  cell.input.missed_cycles = 1;
  const int cycles = cyclesUntilFault(cell, Mode::kStopping);
  EXPECT_NEAR(2 * cycles * scene.period_s, 2.0 + 30.0 + scene.hardware->canopen.stop_deadline_s,
              0.005);
  EXPECT_EQ(cell.cycle.report().fault, Fault::kDriveStateLost);
}

/// Of slow joints, and whatever the period.
TEST(ControlCycleTimes, ARetreatHasASecondAndAHalf) {
  for (const double period_s : {0.0005, 0.001}) {
    Scene scene = test::shippedScene("scenario1_null_space");
    scene.period_s = period_s;
    for (BusConfig& bus : scene.hardware->buses) bus.bit_rate_per_s = 4e6;  // for so many frames
    scene.controller.limits.max_velocity.setConstant(0.005);
    VirtualRobotCell cell(scene);
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 10'000)) << faultName(cell.cycle.report().fault);
    cell.on_frame = [](int bus, CanFrame& frame) {
      if (bus == 3 && frame.id == 0x100) frame.data[4] = 5;  // 3.3 N
    };
    for (int i = 0; i < 500; ++i) cell.step();
    cell.on_frame = [](int bus, CanFrame& frame) {
      if (bus == 3) frame.id = 0x7FF;
    };
    ASSERT_TRUE(cell.runUntil(Mode::kRetreating, 100));
    int cycles = 0;
    for (; cycles < 10'000 && cell.cycle.report().mode == Mode::kRetreating; ++cycles) cell.step();
    EXPECT_NEAR(cycles * period_s, 1.5, 0.005) << period_s;
  }
}

/// All follow at last, but for less than the brakes need: none of them is to blame.
TEST(ControlCycleTimes, NoDriveIsNamedWhereAllFollowAtTheEnd) {
  Scene scene = bareScene();
  scene.hardware->gpio.emplace().brake.emplace();
  scene.hardware->gpio->brake_switching_s = 0.15;
  VirtualRobotCell cell(scene);
  bool is_deaf = true;
  cell.on_send = [&](int, CanFrame& frame) {
    return !is_deaf || frame.id < 0x200 || frame.id >= 0x280;
  };
  ASSERT_TRUE(cell.runUntil(Mode::kEnabling, 5000));
  for (int i = 0; i < 2050; ++i) cell.step();
  is_deaf = false;
  cyclesUntilFault(cell, Mode::kEnabling);
  EXPECT_EQ(cell.cycle.report().fault, Fault::kDriveStateLost);
  EXPECT_EQ(cell.cycle.report().joint, -1);
}

/// In the very cycle in which time is over.
TEST(ControlCycleTimes, NoDriveIsNamedWhereAllAreOffAtTheEnd) {
  VirtualRobotCell stopping(bareScene());
  ASSERT_TRUE(stopping.runUntil(Mode::kRunning, 5000));
  holdPower(stopping, 4);
  stopping.input.stop_requested = true;
  ASSERT_TRUE(stopping.runUntil(Mode::kStopping, 1));
  VirtualRobotCell last = stopping;
  const int cycles = cyclesUntilFault(last, Mode::kStopping);
  for (int i = 0; i < cycles - 12; ++i) stopping.step();
  int named = 0, unnamed = 0;
  for (int before = 12; before >= 0; --before, stopping.step()) {
    VirtualRobotCell cell = stopping;
    cell.on_send = nullptr;
    while (cell.cycle.report().fault == Fault::kNone && !cell.cycle.isFinished()) cell.step();
    if (cell.cycle.isFinished()) continue;
    ASSERT_EQ(cell.cycle.report().fault, Fault::kDriveStateLost);
    const bool has_power = cell.cycle.robot().hasPower(4);
    EXPECT_EQ(cell.cycle.report().joint, has_power ? 4 : -1);
    ++(has_power ? named : unnamed);
  }
  EXPECT_GT(named, 0);
  EXPECT_EQ(unnamed, 1);
}

/// Two seconds more than the drives' set-up may take, and the longest tare of a module.
TEST(ControlCycleTimes, ModulesHaveTwoSecondsForTheirFirstSamples) {
  Scene scene = test::shippedScene("whole_arm/crops9_skin_two_links");
  auto& modules = scene.hardware->tactile_modules;
  for (std::size_t i = 0; i < modules.size(); ++i) modules[i].tare_samples = i == 1 ? 150 : 50;
  VirtualRobotCell cell(scene);
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3) frame.id = 0x7FF;
  };
  const double most_s =
      scene.hardware->canopen.boot_timeout_s + 2.0 + 150 * modules[1].channels.sample_period_s;
  EXPECT_NEAR(cyclesUntilFault(cell, Mode::kBoot) * scene.period_s, most_s, 0.003);
  EXPECT_EQ(cell.cycle.report().fault, Fault::kTactileStale);
}

Scene slowScene() {
  Scene scene = bareScene();
  scene.controller.limits.max_acceleration.setConstant(0.02);
  scene.controller.limits.max_acceleration[8] = 50.0;  // the slowest counts
  return scene;
}

/// An arm that ramps for many seconds is left to do so.
TEST(ControlCycleTimes, AStopMayTakeAsLongAsItsRamp) {
  VirtualRobotCell cell(slowScene());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 5000; ++i) cell.step();
  cell.input.stop_requested = true;
  int cycles = 0;
  for (; cycles < 20000 && !cell.cycle.isFinished(); ++cycles) cell.step();
  EXPECT_TRUE(cell.cycle.isFinished());
  EXPECT_GT(cycles, 2700) << "it hardly moved: this test is blind";
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNone);
  EXPECT_TRUE(cell.areDrivesOff());
}

/// On a computer that is too slow as on any other, though it can tell so only now and then.
TEST(ControlCycleTimes, ARampTakesNoLongerWhereCyclesAreMissed) {
  const auto ramp_s = [](int missed) {
    Scene scene = slowScene();
    scene.controller.limits.max_acceleration[8] = 0.05;
    VirtualRobotCell cell(scene);
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    for (int i = 0; i < 5000; ++i) cell.step();
    const std::int64_t start_ns = cell.t_ns;
    cell.input.late_in_a_row = 4;
    for (int i = 0; i < 5000; ++i) {
      cell.input.missed_cycles = missed;
      cell.t_ns += 1'000'000 * missed;
      cell.step();
      if (cell.largestSetpoint() == 0) break;
    }
    EXPECT_EQ(cell.cycle.report().fault, Fault::kOverrun);
    return 1e-9 * static_cast<double>(cell.t_ns - start_ns);
  };
  const double undisturbed_s = ramp_s(0);
  EXPECT_GT(undisturbed_s, 0.3) << "it hardly moved: this test is blind";
  for (const int missed : {1, 2}) EXPECT_NEAR(ramp_s(missed), undisturbed_s, 0.02) << missed;
}

/// Where a joint should be while it ramps is where it has been commanded to meanwhile.
TEST(ControlCycleTimes, AStopGoesOnWithItsPlaces) {
  VirtualRobotCell cell(slowScene());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 5000; ++i) cell.step();
  cell.input.stop_requested = true;
  const double q_stop = cell.record().q[4];
  for (int i = 0; i < 800; ++i) cell.step();
  ASSERT_EQ(cell.cycle.report().mode, Mode::kStopping);
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 1 && frame.id == 0x182) frame.data[4] ^= 0x10;  // 1 rad off
  };
  double q_before = cell.record().q[4];
  for (int i = 0; i < 100 && cell.cycle.report().fault == Fault::kNone; ++i) {
    q_before = cell.record().q[4];
    cell.step();
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kFollowingError);
  EXPECT_EQ(cell.cycle.report().joint, 4);
  EXPECT_NEAR(cell.cycle.report().q_expected, q_before, 1e-3);
  EXPECT_GT(std::abs(q_before - q_stop), 5e-3) << "it hardly moved: this test is blind";
}

}  // namespace
}  // namespace tactus
