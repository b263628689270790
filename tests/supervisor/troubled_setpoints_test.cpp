#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

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

/// Those of the first drive, in so many cycles.
struct ChangedSetpoints {
  ChangedSetpoints(const Scene& scene, int cycles, const std::function<void(CanFrame&)>& change)
      : cell(scene) {
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    for (int i = 0; i < 200; ++i) cell.step();
    const int bus = scene.hardware->drives[0].bus;
    cell.on_send = [bus, change, left = cycles](int at, CanFrame& frame) mutable {
      if (at == bus && frame.id == 0x201 && left-- > 0) change(frame);
      return true;
    };
  }
  double speed() const { return std::abs(cell.plant.drive(0).velocity()); }

  VirtualRobotCell cell;
};

constexpr double kSlackOfLimit = 1.1;
constexpr double kSeen_s = 0.01;  ///< on the way to the drive, to its motion, and back

/// All bits, one a run.
TEST(ControlCycleChangedSetpoints, TheDriveHeedsTheJointsLimit) {
  const Scene scene = test::shippedScene("scenario1_multi_space");
  const DriveConfig& drive = scene.hardware->drives[0];
  double fastest = 0.0;
  for (unsigned bit = 16; bit < 48; ++bit) {
    ChangedSetpoints run(scene, 1, [bit](CanFrame& frame) {
      frame.data[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    });
    for (int i = 0; i < 300; ++i) {
      run.cell.step();
      EXPECT_LE(run.speed(), kSlackOfLimit * drive.max_velocity + 2.0 / drive.counts_per_unit);
      fastest = std::max(fastest, run.speed());
    }
    EXPECT_EQ(run.cell.cycle.report().fault, Fault::kNone) << "a cycle of it is a few mm, " << bit;
  }
  EXPECT_GT(fastest, drive.max_velocity) << "the limit was needed";
}

/// In all cycles from one on: the drive heeds its control word.
TEST(ControlCycleChangedSetpoints, WhereItLastsTheArmStopsWithinTheFollowingError) {
  const Scene scene = test::shippedScene("scenario1_multi_space");
  const DriveConfig& drive = scene.hardware->drives[0];
  for (const int highest : {0x40, 0xC0}) {
    ChangedSetpoints run(scene, 1 << 30, [=](CanFrame& frame) {
      frame.data[5] = static_cast<std::uint8_t>(highest);
    });
    const double until_s = drive.max_following_error / drive.max_velocity + kSeen_s;
    for (double t_s = 0.0; t_s < until_s; t_s += scene.period_s) run.cell.step();
    EXPECT_EQ(run.cell.cycle.report().fault, Fault::kFollowingError);
    for (int i = 0; i < 6000; ++i) run.cell.step();  // by 1 m/s^2, which is the drive's own ramp
    EXPECT_LT(run.speed(), 1e-3);
  }
}

}  // namespace
}  // namespace tactus
