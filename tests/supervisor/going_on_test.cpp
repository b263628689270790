#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "support/hand.h"
#include "support/scene_by_law.h"
#include "support/virtual_robot_cell.h"

/// What an arm that was held goes on with: nothing that it felt meanwhile may move it.
namespace tactus {
namespace {

using test::Hand;
using test::kLaws;
using test::sceneByLaw;
using test::VirtualRobotCell;

constexpr double kMaxSurplus = 0.25;  ///< m/s or rad/s above a hold without trouble

/// A cell that has been running for as many cycles.
VirtualRobotCell runningCell(const std::string& variant, int cycles) {
  VirtualRobotCell cell(sceneByLaw("scenario1_multi_space", variant));
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < cycles; ++i) cell.step();
  return cell;
}

void step(VirtualRobotCell& cell, int cycles) {
  for (int i = 0; i < cycles; ++i) cell.step();
}

/// Fastest joint in the next seconds, after enable off and on.
double peakOnGoingOn(VirtualRobotCell& cell) {
  cell.switchEnable();
  double fastest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    cell.step();
    for (int k = 0; k < 9; ++k) fastest = std::max(fastest, std::abs(cell.record().dq[k]));
  }
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
  return fastest;
}

struct Holding {
  const char* name;
  double force_N;
  int cycles;
  bool along_y;
  int begins_at;  ///< of the hand, in the hold; < 0: before it
  int gone_for;   ///< before going on
};

constexpr Holding kHoldings[] = {
    {"10 s of 15 N", 15.0, 10000, true, 200, 300},
    {"gone just now", 15.0, 2000, true, 200, 5},
    {"from before", 15.0, 3000, true, -100, 300},
};

/// Holds a running arm, with or without the hand.
double peakAfter(const VirtualRobotCell& running, const Holding& holding, bool has_hand) {
  VirtualRobotCell cell = running;
  const Hand hand{has_hand ? holding.force_N : 0.0, holding.along_y};
  const auto push = [hand](int bus, CanFrame& frame) { hand.push(bus, frame); };
  if (holding.begins_at < 0) {
    cell.on_frame = push;
    step(cell, -holding.begins_at);
  }
  cell.input.lines.enable = false;
  step(cell, std::max(0, holding.begins_at));
  cell.on_frame = push;
  step(cell, holding.cycles);
  cell.on_frame = nullptr;
  step(cell, holding.gone_for);
  EXPECT_EQ(cell.cycle.report().mode, Mode::kHolding);
  return peakOnGoingOn(cell);
}

TEST(GoingOn, AHandDuringAHoldMovesNothingLater) {
  for (const char* law : kLaws) {
    for (const int at : {2000, 7000}) {  // in free motion, and in contact
      const VirtualRobotCell running = runningCell(law, at);
      for (const Holding& holding : kHoldings) {
        const double undisturbed = peakAfter(running, holding, false);
        const double peak = peakAfter(running, holding, true);
        std::printf("%-11s at %d, %-16s peak %.3f, undisturbed %.3f\n", law, at, holding.name, peak,
                    undisturbed);
        EXPECT_LE(peak, undisturbed + kMaxSurplus) << law << " " << holding.name;
      }
    }
  }
}

/// As of a virtual machine that stood still: the path has not gone on without the arm.
TEST(GoingOn, AnArmThatAPauseHasStoppedMakesUpForNoneOfIt) {
  const VirtualRobotCell running = runningCell("null_space", 2000);
  const auto peakAfterPause = [&](int missed) {
    VirtualRobotCell cell = running;
    cell.pause(missed);
    EXPECT_EQ(cell.cycle.report().missed_cycles, missed);
    EXPECT_NEAR(cell.record().task_time_s, running.record().task_time_s + 0.001, 1e-9);
    step(cell, 1000);
    EXPECT_EQ(cell.cycle.report().mode, Mode::kFault);
    return peakOnGoingOn(cell);
  };
  const double undisturbed = peakAfterPause(10);
  EXPECT_LE(peakAfterPause(5000), undisturbed + 0.02);
  EXPECT_LE(peakAfterPause(100'000), undisturbed + 0.02);
}

TEST(GoingOn, ASilentModuleInContactMovesNothingLater) {
  for (const char* law : kLaws) {
    const VirtualRobotCell running = runningCell(law, 7000);
    double peaks[2];
    for (const bool is_silent : {false, true}) {
      VirtualRobotCell cell = running;
      if (!is_silent) cell.input.lines.enable = false;
      cell.on_frame = [is_silent](int bus, CanFrame& frame) {
        if (is_silent && bus == 3) frame.id = 0x7FF;
      };
      step(cell, 10000);
      cell.on_frame = nullptr;
      step(cell, 600);
      ASSERT_EQ(cell.cycle.report().mode, Mode::kHolding);
      peaks[is_silent] = peakOnGoingOn(cell);
    }
    std::printf("%-11s peak %.3f, undisturbed %.3f\n", law, peaks[1], peaks[0]);
    EXPECT_LE(peaks[1], peaks[0] + kMaxSurplus) << law;
  }
}

/// A module under a cover of weight. While drives boot nobody knows where joints are.
Scene sceneWithCover(int tare_samples) {
  Scene scene = sceneByLaw("scenario1_multi_space", "null_limit");
  for (TactileModuleConfig& module : scene.controller.tactile_modules)
    module.cover = CoverConfig{0.4, Vector3(0.19, 0.0, 0.0)};
  scene.controller.gravity_Base = Vector3(0.0, 0.0, -9.81);
  for (CanTactileConfig& module : scene.hardware->tactile_modules)
    module.tare_samples = tare_samples;
  return scene;
}

TEST(GoingOn, DrivesThatBootAreNoPushOnACover) {
  VirtualRobotCell cell(sceneWithCover(50));
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  step(cell, 500);
  for (int restart = 0; restart < 2; ++restart) {
    cell.input.lines.emergency_stop = true;
    step(cell, 1000);
    cell.input.lines.emergency_stop = false;
    const double before_N = cell.record().force_sensor_N[0];
    cell.switchEnable();
    for (int i = 0; i < 300; ++i) {
      cell.step();
      if (cell.cycle.report().mode == Mode::kBoot) continue;
      ASSERT_NEAR(cell.record().force_sensor_N[0], before_N, 0.5) << i;
    }
    EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning) << faultName(cell.cycle.report().fault);
  }
}

TEST(GoingOn, DrivesThatBootAreNoPushOnACoverThatIsTaredInNoTime) {
  VirtualRobotCell cell(sceneWithCover(1));
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000)) << faultName(cell.cycle.report().fault);
}

}  // namespace
}  // namespace tactus
