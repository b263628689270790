#include <gtest/gtest.h>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// The tactile module falls silent for long while the arm moves, and comes back.
namespace tactus {
namespace {

using test::VirtualRobotCell;

TEST(ControlCycleTactileSilence, EndsWithTheFirstSampleWhateverItsNumber) {
  Scene scene = test::shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  VirtualRobotCell silent(scene);
  ASSERT_TRUE(silent.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 1000; ++i) silent.step();
  silent.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3) frame.id = 0x7FF;
  };
  for (int i = 0; i < 10'000; ++i) silent.step();
  ASSERT_EQ(silent.cycle.report().fault, Fault::kTactileStale);
  ASSERT_EQ(silent.cycle.report().mode, Mode::kHolding);
  for (int phase = 0; phase < 16; ++phase) {
    SCOPED_TRACE(phase);
    VirtualRobotCell cell = silent;
    cell.on_frame = nullptr;
    for (int i = 0; i < 10; ++i) cell.step();
    EXPECT_EQ(cell.cycle.report().mode, Mode::kHolding) << "not before the enable line says so";
    cell.switchEnable();
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5)) << faultName(cell.cycle.report().fault);
    for (int i = 0; i < 16 * 4; ++i) silent.step();  // 16 samples on: a sixteenth of the numbers
  }
}

/// The first cycle of motion gives the controller a new state, but the sample no new age.
TEST(ControlCycleTactileSilence, IsSeenInTimeAlsoWhereItBeganBeforeTheMotion) {
  constexpr int kLongest = 20;  // ms, before the motion
  Scene scene = test::shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace().brake.emplace();  // which take their time to open
  VirtualRobotCell booted(scene);
  ASSERT_TRUE(booted.runUntil(Mode::kEnabling, 5000));
  int cycles_to_run = 0;
  for (VirtualRobotCell cell = booted; cell.cycle.report().mode != Mode::kRunning; cell.step())
    ASSERT_LT(++cycles_to_run, 1000);
  ASSERT_GE(cycles_to_run, kLongest);
  int seen_running = 0;
  for (int before = 0; before < kLongest; ++before) {
    VirtualRobotCell cell = booted;
    for (int i = 0; i < cycles_to_run - before; ++i) cell.step();
    cell.on_frame = [](int bus, CanFrame& frame) {
      if (bus == 3) frame.id = 0x7FF;
    };
    constexpr int kLatest = 20 + 2;  // the largest age, and two cycles to see it
    for (int i = 0; i < kLatest; ++i) {
      cell.step();
      seen_running += cell.cycle.report().mode == Mode::kRunning ? 1 : 0;
    }
    EXPECT_EQ(cell.cycle.report().fault, Fault::kTactileStale) << before;
    EXPECT_NE(cell.cycle.report().mode, Mode::kRunning) << before;
  }
  EXPECT_GT(seen_running, 100);
}

}  // namespace
}  // namespace tactus
