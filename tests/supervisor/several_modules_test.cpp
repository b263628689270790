#include <gtest/gtest.h>

#include <cmath>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/record/fault_text.h"

/// An arm with two tactile modules on one bus, which a controller without a law only reads.
namespace tactus {
namespace {

using test::VirtualRobotCell;

constexpr std::uint32_t kSecondId = 0x110;

Scene twoModules() {
  Scene scene = test::shippedScene("scenario1_none");
  scene.controller.tactile_modules.push_back(scene.controller.tactile_modules.front());
  scene.controller.tactile_modules.back().link.joint = 5;
  scene.plant.modules.push_back(scene.plant.modules.front());
  scene.hardware->tactile_modules.push_back(scene.hardware->tactile_modules.front());
  scene.hardware->tactile_modules.back().first_id = kSecondId;
  scene.module_links.push_back("link6");
  return scene;
}

bool isOfSecond(int bus, const CanFrame& frame) {
  return bus == 3 && frame.id >= kSecondId && frame.id < kSecondId + 4;
}

void runFor(VirtualRobotCell& cell, int cycles) {
  for (int i = 0; i < cycles; ++i) cell.step();
}

TEST(SeveralModules, AreAllReadAndRecorded) {
  VirtualRobotCell cell(twoModules());
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000)) << faultName(cell.cycle.report().fault);
  double largest_N = 0.0;
  for (int i = 0; i < 8000; ++i) {
    cell.step();
    const CycleRecord record = cell.record();
    largest_N = std::max(largest_N, record.force_sensor_N[0]);
    for (int module = 0; module < 2; ++module) {
      const double force_N =
          std::hypot(record.tactile_force_y_N[module], record.tactile_force_z_N[module]);
      ASSERT_NEAR(record.force_sensor_N[module], force_N, 1e-12);
    }
    ASSERT_EQ(record.tactile_sequence[2], 0u);
  }
  EXPECT_GT(largest_N, 1.0);
  EXPECT_GT(cell.record().tactile_sequence[0], 1000u);
  EXPECT_GT(cell.record().tactile_sequence[1], 1000u);
}

TEST(SeveralModules, HaveFaultsThatNameThem) {
  const Scene scene = twoModules();
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (isOfSecond(bus, frame)) frame.id = 0x7FF;
  };
  runFor(cell, 30);
  const ModeReport& report = cell.cycle.report();
  EXPECT_EQ(report.fault, Fault::kTactileStale);
  EXPECT_EQ(report.detail.module, 1);
  EXPECT_NE(faultEvent(report, scene).find("tactile_stale, tactile module link6, at "),
            std::string::npos)
      << faultEvent(report, scene);
}

TEST(SeveralModules, AllHaveToBeTaredBeforeTheArmMoves) {
  VirtualRobotCell cell(twoModules());
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (isOfSecond(bus, frame)) frame.data[1] |= 2;  // a broken cable
  };
  EXPECT_FALSE(cell.runUntil(Mode::kRunning, 2000));
  EXPECT_EQ(cell.cycle.report().fault, Fault::kTareRefused);
  EXPECT_EQ(cell.cycle.report().detail.module, 1);
}

/// The first one is tared and fresh: it is not the one that is missed.
TEST(SeveralModules, OneThatNeverSpeaksIsMissedByItsNumber) {
  VirtualRobotCell cell(twoModules());
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (isOfSecond(bus, frame)) frame.id = 0x7FF;
  };
  EXPECT_FALSE(cell.runUntil(Mode::kRunning, 8000));
  EXPECT_EQ(cell.cycle.report().fault, Fault::kTactileStale);
  EXPECT_EQ(cell.cycle.report().detail.module, 1);
}

}  // namespace
}  // namespace tactus
