#include <gtest/gtest.h>

#include <cmath>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// The setpoints of one drive get lost, quick stop included, while SYNC and heartbeat reach it.
namespace tactus {
namespace {

using test::VirtualRobotCell;

TEST(ControlCycleLostSetpoints, TheDriveStopsByItselfWithinTheHeartbeatTimeout) {
  Scene scene = test::shippedScene("scenario1_multi_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();  // the daemon goes on after the fault
  Trouble lost;
  lost.from_s = 1.0;
  lost.until_s = 10.0;
  lost.id = 0x201;
  scene.troubles = {lost};
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  const SlaveDrive& drive = cell.plant.drive(0);
  for (int i = 0; i < 960; ++i) cell.step();
  ASSERT_GT(std::abs(drive.velocity()), 1e-4) << "moves";
  for (int i = 0; i < 200; ++i) cell.step();
  EXPECT_EQ(drive.velocity(), 0.0);
  EXPECT_EQ(drive.powerState(), PowerState::kFault);
  EXPECT_EQ(drive.objects().get(0x603F), 0x8250u);
  EXPECT_EQ(cell.plant.drive(1).objects().get(0x603F), 0u) << "the others were told to stop";
  EXPECT_NE(cell.cycle.report().fault, Fault::kNone);
}

}  // namespace
}  // namespace tactus
