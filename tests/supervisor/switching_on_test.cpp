#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// Drives that switch on: that they all do, and that they stop doing so.
namespace tactus {
namespace {

using test::VirtualRobotCell;

constexpr int kSlowBrake_cycles = 150;

Scene sceneWithEnable() {
  Scene scene = test::shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->brake.emplace();
  scene.hardware->gpio->enable.emplace();
  scene.hardware->gpio->brake_switching_s = 1e-3 * kSlowBrake_cycles;
  return scene;
}

/// A drive that lets go again as soon as it was seen enabled, as where its power stage trips
/// without a fault: the arm does not go on without it, with its brake open.
TEST(SwitchingOn, ADriveThatLetsGoAtTheFirstMomentStopsTheArm) {
  for (const int enabled_cycles : {1, 2, 3}) {
    Scene scene = sceneWithEnable();
    scene.hardware->gpio->brake.reset();
    VirtualRobotCell cell(scene);
    int asked = 0;
    cell.on_send = [&](int bus, CanFrame& frame) {
      if (bus != 0 || frame.id != 0x201) return true;
      if (frame.data[0] == 0x0F) ++asked;
      if (asked > enabled_cycles) frame.data[0] = 0;
      return true;
    };
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    EXPECT_TRUE(cell.runUntil(Mode::kFault, 10)) << enabled_cycles;
    EXPECT_EQ(cell.cycle.report().fault, Fault::kDriveStateLost);
    EXPECT_EQ(cell.cycle.report().joint, 0);
  }
}

/// A lost frame costs a drive no more than its next heartbeat.
TEST(SwitchingOn, EachDriveIsToldAgainToStartIfTheFirstTimeIsLost) {
  VirtualRobotCell cell(test::shippedScene("scenario1_null_space"));
  std::set<std::pair<int, int>> lost;
  cell.on_send = [&](int bus, CanFrame& frame) {
    const bool is_start = frame.id == 0 && frame.data[0] == 1;
    return !is_start || !lost.emplace(bus, frame.data[1]).second;
  };
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000)) << faultName(cell.cycle.report().fault);
  EXPECT_EQ(lost.size(), 9u);
}

/// What the daemon sends to joint 4 has this control word instead, where it is another one.
void holdControlWord(VirtualRobotCell& cell, std::uint8_t instead_of, std::uint8_t word) {
  cell.on_send = [=](int bus, CanFrame& frame) {
    if (bus == 1 && frame.id == 0x202 && frame.data[0] == instead_of) frame.data[0] = word;
    return true;
  };
}

void expectJoint4IsNamed(const VirtualRobotCell& cell) {
  const ModeReport& report = cell.cycle.report();
  EXPECT_EQ(report.fault, Fault::kDriveStateLost);
  EXPECT_EQ(report.joint, 4);
  EXPECT_EQ(report.drive.state, DriveState::kSwitchedOn);
}

TEST(SwitchingOn, ADriveThatDoesNotInTimeIsNamed) {
  VirtualRobotCell cell(sceneWithEnable());
  holdControlWord(cell, 0x0F, 0x07);
  ASSERT_TRUE(cell.runUntil(Mode::kFault, 10'000));
  expectJoint4IsNamed(cell);
}

TEST(SwitchingOn, ADriveThatDoesNotSwitchOffInTimeIsNamed) {
  VirtualRobotCell cell(sceneWithEnable());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  holdControlWord(cell, 0x02, 0x07);
  cell.input.stop_requested = true;
  ASSERT_TRUE(cell.runUntil(Mode::kFault, 20'000));
  expectJoint4IsNamed(cell);
}

/// Whoever takes the enable line away while drives switch on does not want them to go on with it.
TEST(SwitchingOn, NoDriveGetsPowerAfterAnEnablingCutShort) {
  for (const int after : {0, 1, 2, 3, 4}) {
    VirtualRobotCell cell(sceneWithEnable());
    ASSERT_TRUE(cell.runUntil(Mode::kEnabling, 5000));
    for (int i = 0; i < after; ++i) cell.step();
    ASSERT_FALSE(cell.cycle.lines().release_brake);
    cell.input.lines.enable = false;
    for (int i = 0; i < 5; ++i) cell.step();  // what is on its way
    for (int i = 0; i < 2 * kSlowBrake_cycles; ++i) {
      cell.step();
      ASSERT_TRUE(cell.areDrivesLimp()) << after << ", " << i;
      ASSERT_FALSE(cell.cycle.lines().release_brake);
    }
    EXPECT_EQ(cell.cycle.report().mode, Mode::kReady);
  }
}

}  // namespace
}  // namespace tactus
