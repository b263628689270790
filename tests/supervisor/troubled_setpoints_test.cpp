#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// What the daemon sends to one drive gets lost or becomes another on its way.
namespace tactus {
namespace {

using test::VirtualRobotCell;

/// Quick stop included, while SYNC and heartbeat reach it.
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

/// All bits of its velocity, one a run: the drive is as fast as the joint may be, at most.
TEST(ControlCycleChangedSetpoints, TheDriveHeedsTheJointsLimit) {
  const Scene scene = test::shippedScene("scenario1_multi_space");
  const DriveConfig& drive = scene.hardware->drives[0];
  double fastest = 0.0;
  for (unsigned bit = 16; bit < 48; ++bit) {
    VirtualRobotCell cell(scene);
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    for (int i = 0; i < 200; ++i) cell.step();
    bool is_changed = false;
    cell.on_send = [&](int bus, CanFrame& frame) {
      if (bus == drive.bus && frame.id == 0x201 && !std::exchange(is_changed, true))
        frame.data[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
      return true;
    };
    for (int i = 0; i < 300; ++i) {
      cell.step();
      const double speed = std::abs(cell.plant.drive(0).velocity());
      EXPECT_LE(speed, drive.max_velocity + 2.0 / drive.counts_per_unit) << bit;
      fastest = std::max(fastest, speed);
    }
    EXPECT_TRUE(is_changed);
    if (cell.cycle.report().fault != Fault::kNone) {
      EXPECT_LT(std::abs(cell.plant.drive(0).velocity()), 1e-3) << bit;
    }
  }
  EXPECT_GT(fastest, 0.9 * drive.max_velocity) << "the limit was needed";
}

}  // namespace
}  // namespace tactus
