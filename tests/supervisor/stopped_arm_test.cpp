#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// An arm that goes on after a hold, an e-stop or a start that was broken off.
namespace tactus {
namespace {

using test::VirtualRobotCell;

Scene stoppableScene() {
  Scene scene = test::shippedScene("scenario1_null_space", {{"simulation.obstacles", "[]"}});
  scene.hardware->gpio.emplace().brake.emplace();
  scene.hardware->gpio->enable.emplace();
  scene.hardware->gpio->brake_switching_s = 0.15;
  return scene;
}

double fastestCommand(const VirtualRobotCell& cell) {
  const CycleRecord record = cell.record();
  return std::abs(*std::max_element(std::begin(record.dq), std::end(record.dq),
                                    [](double a, double b) { return std::abs(a) < std::abs(b); }));
}

/// However soon the enable line is on again.
TEST(StoppedArm, GoesOnFromAHoldOnlyOnceItRests) {
  Scene scene = stoppableScene();
  scene.controller.limits.max_acceleration.setConstant(0.02);
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 5000; ++i) cell.step();
  cell.input.lines.enable = false;
  cell.step();
  cell.step();
  cell.input.lines.enable = true;
  int cycles = 0;
  double fastest = 1.0;
  for (; cycles < 10'000 && cell.cycle.report().mode != Mode::kRunning; ++cycles) {
    ASSERT_EQ(cell.cycle.report().mode, Mode::kHolding);
    fastest = fastestCommand(cell);
    cell.step();
  }
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
  EXPECT_EQ(fastest, 0.0);
  EXPECT_GT(cycles, 100) << "it hardly moved: this test is blind";
}

/// A stop may lead a joint farther than an arm may be from its start, but no farther than a stop
/// leads: there it goes on.
TEST(StoppedArm, GoesOnFromWhereEachDriveHasStoppedItsJoint) {
  const Scene scene = stoppableScene();
  VirtualRobotCell running(scene);
  ASSERT_TRUE(running.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 2000; ++i) running.step();
  running.input.lines.emergency_stop = true;
  for (const int joint : {0, 4, 8}) {
    for (const double tolerances : {1.5, -1.5}) {
      VirtualRobotCell cell = running;
      const double counts = scene.hardware->drives[joint].counts_per_unit;
      const auto way =
          static_cast<std::int32_t>(tolerances * scene.hardware->start_tolerance * counts);
      cell.on_frame = [=](int bus, CanFrame& frame) {
        if (bus != joint / 3 || frame.id != 0x181U + static_cast<std::uint32_t>(joint % 3)) return;
        std::int32_t position = 0;
        std::memcpy(&position, frame.data.data() + 2, sizeof(position));
        position += way;
        std::memcpy(frame.data.data() + 2, &position, sizeof(position));
      };
      for (int i = 0; i < 500; ++i) cell.step();
      ASSERT_TRUE(cell.areDrivesOff());
      cell.input.lines.emergency_stop = false;
      cell.switchEnable();
      EXPECT_TRUE(cell.runUntil(Mode::kRunning, 4000))
          << joint << " " << faultName(cell.cycle.report().fault);
    }
  }
}

/// That brakes were open once, before drives were off, is no reason to give drives power.
TEST(StoppedArm, GetsNoPowerInALaterStartThatIsCutShort) {
  VirtualRobotCell enabling(stoppableScene());
  ASSERT_TRUE(enabling.runUntil(Mode::kRunning, 5000));
  enabling.input.lines.emergency_stop = true;
  for (int i = 0; i < 500; ++i) enabling.step();
  enabling.input.lines.emergency_stop = false;
  enabling.switchEnable();
  ASSERT_TRUE(enabling.runUntil(Mode::kEnabling, 5000));
  bool had_power = false;
  for (int after = 0; !enabling.cycle.lines().release_brake; ++after, enabling.step()) {
    ASSERT_LT(after, 100);
    VirtualRobotCell cell = enabling;
    cell.input.lines.enable = false;
    for (int i = 0; i < 5; ++i) {  // what is on its way
      cell.step();
      had_power |= !cell.areDrivesOff();
    }
    for (int i = 0; i < 300; ++i) {
      cell.step();
      ASSERT_TRUE(cell.areDrivesLimp()) << after << ", " << i;
    }
    EXPECT_EQ(cell.cycle.report().mode, Mode::kReady);
  }
  EXPECT_TRUE(had_power) << "this test is blind";
}

}  // namespace
}  // namespace tactus
