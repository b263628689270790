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

}  // namespace
}  // namespace tactus
