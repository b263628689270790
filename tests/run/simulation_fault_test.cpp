#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/shipped_scene.h"
#include "tactus/record/replay.h"
#include "tactus/run/simulation.h"
#include "tactus/supervisor/mode.h"

namespace tactus {
namespace {

TEST(SimulationFault, IsToldWithTheForceThatTheLogHas) {
  Scene scene = test::shippedScene("scenario1_none");
  const double limit_N = 3.0;
  scene.controller.tactile_modules.front().max_force_N = limit_N;
  std::vector<CycleRecord> faulty;
  const FaultReport end = simulate(scene, [&](const CycleRecord& record) {
                            if (record.fault != 0) faulty.push_back(record);
                          }).figures.end;
  ASSERT_FALSE(faulty.empty());
  const CycleRecord& first = faulty.front();
  EXPECT_EQ(end.fault, Fault::kTactileInvalid);
  EXPECT_EQ(end.time_s, first.t_s);
  EXPECT_EQ(end.detail.value, std::hypot(first.tactile_force_y_N[0], first.tactile_force_z_N[0]));
  EXPECT_GT(end.detail.value, limit_N);
  EXPECT_LT(end.detail.value, limit_N + 1.0) << "of the first sample beyond it";
  EXPECT_EQ(end.detail.limit, limit_N);
  EXPECT_STREQ(end.detail.unit, "N");
}

std::vector<CycleRecord> recordsOf(const Scene& scene) {
  std::vector<CycleRecord> records;
  simulate(scene, [&](const CycleRecord& record) { records.push_back(record); });
  return records;
}

/// The same as tactusd's: the arm leaves the contact, the task's clock stands still, and a moment
/// of rest shows what is left.
TEST(SimulationFault, EndsInARetreat) {
  Scene scene = test::shippedScene("scenario1_none");
  scene.controller.tactile_modules.front().max_force_N = 10.0;
  const std::vector<CycleRecord> records = recordsOf(scene);
  const auto mode = [&](std::size_t i) { return static_cast<Mode>(records[i].mode); };
  std::size_t faulty = 0;
  while (faulty < records.size() && records[faulty].fault == 0) ++faulty;
  ASSERT_LT(faulty + 1, records.size());
  EXPECT_EQ(mode(faulty), Mode::kRunning);
  EXPECT_EQ(mode(faulty + 1), Mode::kRetreating);
  EXPECT_EQ(mode(records.size() - 1), Mode::kHolding);
  EXPECT_GT(records[faulty].force_sensor_N[0], 9.0);
  EXPECT_LT(records.back().force_sensor_N[0], 1.2);
  EXPECT_EQ(records.back().fault, static_cast<std::uint64_t>(Fault::kTactileInvalid));
  EXPECT_LT(records.back().t_s, records[faulty].t_s + 2.0);
  for (std::size_t i = faulty + 1; i < records.size(); ++i)
    ASSERT_EQ(records[i].task_time_s, records[faulty + 1].task_time_s) << i;
  EXPECT_EQ(records[faulty].task_time_s, records[faulty].t_s);
}

TEST(SimulationFault, IsReplayedToTheBit) {
  for (const char* name : {"scenario1_none", "scenario1_multi_space", "scenario3_tactus"}) {
    Scene scene = test::shippedScene(name);
    scene.controller.tactile_modules.front().max_force_N = 4.0;
    const std::vector<CycleRecord> records = recordsOf(scene);
    ASSERT_NE(records.back().fault, 0u) << name;
    const Controller controller(scene.controller);
    Replayer replayer(controller, controller.config().chain.size(), scene.period_s);
    ReplayComparison comparison(describeLog(scene).shape);
    for (const CycleRecord& record : records) comparison.add(record, replayer.replay(record));
    EXPECT_EQ(comparison.differingCycles(), 0) << name;
  }
}

TEST(SimulationFault, IsNoneInARunAsPlanned) {
  Scene scene = test::shippedScene("scenario1_multi_space");
  scene.duration_s = 0.1;
  EXPECT_EQ(simulate(scene, [](const CycleRecord&) {}).figures.end.fault, Fault::kNone);
}

}  // namespace
}  // namespace tactus
