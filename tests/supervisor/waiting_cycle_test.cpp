#include <gtest/gtest.h>

#include <vector>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/math/trajectory.h"
#include "tactus/record/replay.h"

/// The reference's clock in a run of the daemon: it waits for an arm whose joints are too slow for
/// the path, and stands still whenever the task does.
namespace tactus {
namespace {

using test::VirtualRobotCell;

constexpr double kWaitBeyond_m = 0.01;

Scene tooFastForItsJoints() {
  Scene scene = test::shippedScene("scenario1_null_space", {{"simulation.obstacles", "[]"}});
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  scene.controller.gains.task.wait_beyond_m = kWaitBeyond_m;
  scene.controller.gains.task.max_return_speed_m_per_s = 0.25;
  scene.controller.task.trajectory.waypoints[0].speed_m_per_s = 0.3;
  scene.controller.limits.max_velocity.setConstant(0.05);
  return scene;
}

/// A hold, missed cycles, a pause that stops the arm, and an e-stop after which it starts again.
std::vector<CycleRecord> runWithEvents(const Scene& scene) {
  VirtualRobotCell cell(scene);
  std::vector<CycleRecord> records;
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  records.push_back(cell.record());
  for (int i = 0; i < 14000 && !cell.cycle.isFinished(); ++i) {
    const bool is_enable_off = (i > 2000 && i < 2300) || (i > 3600 && i < 3700);
    cell.input.lines.enable = !is_enable_off;
    cell.input.lines.emergency_stop = i > 3000 && i < 3500;
    const bool is_missed = i == 1600 || i == 2100 || i == 5000;
    cell.input.missed_cycles = is_missed ? 2 : 0;
    if (i == 2990) cell.input.missed_cycles = 400;
    cell.input.late_in_a_row = i == 2990 ? 401 : 0;
    if (cell.input.missed_cycles > 0)
      cell.plant.advance(cell.t_ns += 1'000'000 * cell.input.missed_cycles);
    cell.input.stop_requested = i > 13900;
    cell.step();
    records.push_back(cell.record());
  }
  EXPECT_TRUE(cell.cycle.isFinished());
  return records;
}

bool isIn(const CycleRecord& record, Mode mode) {
  return record.mode == static_cast<std::uint64_t>(mode);
}

TEST(WaitingCycle, KeepsItsPlaceOnThePathThroughHoldAndRestart) {
  const Scene scene = tooFastForItsJoints();
  const std::vector<CycleRecord> records = runWithEvents(scene);
  int cycles_in_hold = 0, cycles_in_fault = 0, cycles_booting = 0;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const CycleRecord& before = records[i - 1];
    const CycleRecord& record = records[i];
    const double task_s = record.task_time_s - before.task_time_s;
    const double path_s = record.path_time_s - before.path_time_s;
    ASSERT_GE(path_s, 0.0) << i;
    ASSERT_LE(path_s, task_s + 1e-12) << "at " << record.t_s << " s the reference jumps ahead";
    if (task_s == 0.0) {
      ASSERT_NEAR(record.wd[1], before.wd[1], 1e-12) << i;
    }
    cycles_in_hold += isIn(record, Mode::kHolding);
    cycles_in_fault += isIn(record, Mode::kFault);
    cycles_booting += isIn(record, Mode::kBoot);
  }
  EXPECT_GT(cycles_in_hold, 200);
  EXPECT_GT(cycles_in_fault, 200);
  EXPECT_GT(cycles_booting, 10) << "the drives were set up anew";
  const double end_s = Trajectory(scene.controller.task.trajectory, Pose{}).end_s();
  EXPECT_GT(records[3000].task_time_s - records[3000].path_time_s, 0.2) << "it did wait";
  EXPECT_LT(records[3000].path_time_s, end_s) << "before the e-stop the path has not ended";
  EXPECT_GT(records.back().path_time_s, end_s) << "after it the path is completed";
}

TEST(WaitingCycle, LagsNoMoreThanTwiceItsKey) {
  for (const CycleRecord& record : runWithEvents(tooFastForItsJoints())) {
    if (isIn(record, Mode::kBoot)) continue;  // where the arm is, is not known
    ASSERT_LT(std::abs(record.wd[1] - record.w[1]), 2.1 * kWaitBeyond_m) << record.t_s;
  }
}

TEST(WaitingCycle, ReplaysToTheBit) {
  const Scene scene = tooFastForItsJoints();
  const Controller controller(scene.controller);
  Replayer replayer(controller, 9, scene.period_s);
  ReplayComparison comparison({9, 3});
  for (const CycleRecord& record : runWithEvents(scene))
    comparison.add(record, replayer.replay(record));
  EXPECT_GT(comparison.cycles(), 13000);
  EXPECT_EQ(comparison.differingCycles(), 0)
      << comparison.first()->column << " in cycle " << comparison.first()->cycle;
}

/// As the daemon does it: each cycle is prepared after the one before.
TEST(WaitingCycle, IsTheSameWhenPreparedAhead) {
  const Scene scene = tooFastForItsJoints();
  VirtualRobotCell plain(scene);
  VirtualRobotCell ahead(scene);
  for (int i = 0; i < 4000; ++i) {
    for (VirtualRobotCell* cell : {&plain, &ahead}) {
      cell->input.lines.enable = i < 2000 || i > 2200;
      cell->input.missed_cycles = i == 1600 ? 2 : 0;
      cell->step();
    }
    ahead.cycle.prepare();
    const CycleRecord of_plain = plain.record(), of_ahead = ahead.record();
    ASSERT_EQ(std::memcmp(&of_plain, &of_ahead, sizeof(CycleRecord)), 0) << i;
  }
  EXPECT_LT(plain.record().path_time_s, plain.record().task_time_s - 0.2);
}

}  // namespace
}  // namespace tactus
