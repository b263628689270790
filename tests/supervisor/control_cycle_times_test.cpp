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
