#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <vector>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/record/replay.h"

/// The daemon's retreat on its buses, against the stiff profile of scenario 3 without a law: what
/// the plant's contact has left, how it goes on, and its log.
namespace tactus {
namespace {

using test::VirtualRobotCell;

struct ModuleTrouble {
  Fault fault;
  double from_N;  ///< on the cover; or, without a trouble of its own, what the module takes
  std::function<void(int bus, CanFrame& frame)> on_frame;
};

bool isOfModule(int bus, const CanFrame& frame) {
  return bus == 3 && frame.id >= 0x100 && frame.id < 0x104;
}

std::vector<ModuleTrouble> moduleTroubles() {
  return {
      {Fault::kTactileInvalid, kNoLimit, nullptr},
      {Fault::kTactileStale, 30.0,
       [](int bus, CanFrame& frame) {
         if (isOfModule(bus, frame)) frame.id = 0x7FF;
       }},
      {Fault::kTactileSaturated, 30.0,
       [](int bus, CanFrame& frame) {
         if (!isOfModule(bus, frame) || frame.id != 0x101) return;
         frame.data[2] = frame.data[3] = 0xFF;
         frame.data[4] = 0x7F;
       }},
      {Fault::kTactileCableBreak, 30.0,
       [](int bus, CanFrame& frame) {
         if (!isOfModule(bus, frame)) return;
         frame.data[1] |= 2;
         frame.data[4] = 0;  // and it reads nearly nothing
         frame.data[3] = 0;
       }},
  };
}

Scene pressingScene() {
  Scene scene = test::shippedScene("scenario3_assumed", {{"controller.variant", "none"}});
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  return scene;
}

/// A run until half a second after the fault's cause has gone and the enable line let it go on.
std::vector<CycleRecord> runWith(const ModuleTrouble& trouble) {
  VirtualRobotCell cell(pressingScene());
  std::vector<CycleRecord> records;
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  records.push_back(cell.record());
  const auto step = [&](int cycles) {
    for (int i = 0; i < cycles; ++i) {
      cell.step();
      cell.cycle.prepare();
      records.push_back(cell.record());
    }
  };
  const auto force_N = [&] { return cell.plant.world().trueForce_N(); };
  const auto hasLeft = [&] { return cell.cycle.report().mode != Mode::kRunning; };
  while (records.size() < 12'000 && !hasLeft() && force_N() < trouble.from_N) step(1);
  cell.on_frame = trouble.on_frame;
  while (records.size() < 12'100 && !hasLeft()) step(1);
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRetreating);
  EXPECT_EQ(cell.cycle.report().fault, trouble.fault);
  const double at_fault_N = force_N();
  EXPECT_GT(at_fault_N, 20.0);
  cell.input.missed_cycles = 2;  // the drives go on meanwhile
  cell.plant.advance(cell.t_ns += 2'000'000);
  step(1);
  cell.input.missed_cycles = 0;
  step(1000);
  EXPECT_EQ(cell.cycle.report().mode, Mode::kHolding);
  std::printf("%s: %.1f N, after 1 s %.2f N\n", faultName(trouble.fault), at_fault_N, force_N());
  EXPECT_LE(force_N(), 5.0);
  EXPECT_EQ(cell.largestSetpoint(), 0);
  cell.on_frame = nullptr;
  step(200);
  EXPECT_EQ(cell.cycle.report().mode, Mode::kHolding) << "not before the enable line says so";
  cell.input.lines.enable = false;
  step(50);
  cell.input.lines.enable = true;
  step(500);
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
  EXPECT_LT(force_N(), 60.0) << "gently";
  return records;
}

TEST(RetreatingCycle, LeavesTheContactAndGoesOn) {
  for (const ModuleTrouble& trouble : moduleTroubles()) {
    SCOPED_TRACE(faultName(trouble.fault));
    const std::vector<CycleRecord> records = runWith(trouble);
    double task_s = -1.0;
    for (const CycleRecord& record : records) {
      if (record.mode != static_cast<std::uint64_t>(Mode::kRetreating)) continue;
      if (task_s < 0.0) task_s = record.task_time_s;
      ASSERT_EQ(record.task_time_s, task_s) << "its time stands still";
    }
    EXPECT_GE(task_s, 0.0);
  }
}

TEST(RetreatingCycle, ReplaysToTheBit) {
  const Scene scene = pressingScene();
  const Controller controller(scene.controller);
  for (const ModuleTrouble& trouble : moduleTroubles()) {
    Replayer replayer(controller, 9, scene.period_s);
    ReplayComparison comparison({9, 3});
    for (const CycleRecord& record : runWith(trouble))
      comparison.add(record, replayer.replay(record));
    EXPECT_GT(comparison.cycles(), 3000);
    EXPECT_EQ(comparison.differingCycles(), 0)
        << faultName(trouble.fault) << ": " << comparison.first()->column << " in cycle "
        << comparison.first()->cycle;
  }
}

}  // namespace
}  // namespace tactus
