#include <gtest/gtest.h>

#include <vector>

#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "support/virtual_robot_cell.h"
#include "tactus/record/replay.h"

namespace tactus {
namespace {

/// The daemon's cycle, tuned in contact and back: each cycle prepared ahead with the gains before.
TEST(TunedCycle, ReplaysToTheBitFromItsLog) {
  const Scene scene = test::shippedScene("scenario1_multi_space");
  test::VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  std::vector<CycleRecord> records{cell.record()};
  Gains gains = scene.controller.gains;
  for (int i = 0; i < 8000; ++i) {
    if (i % 1000 == 500) {
      gains.force.time_constant_s = i % 2000 == 500 ? 0.2 : 0.1;
      gains.task.drift_gain_per_s = 5.0 + 1e-3 * i;
      gains.joint_limit_avoidance.active_fraction = i % 2000 == 500 ? 0.4 : 0.5;
    }
    cell.cycle.tune(gains);
    cell.step();
    cell.cycle.prepare();
    records.push_back(cell.record());
  }
  const auto log = test::readLog(test::writeLog(describeLog(scene), records));
  const Controller controller(scene.controller);
  Replayer replayer(controller, 9, scene.period_s);
  ReplayComparison comparison({9, 3});
  double largest_N = 0.0;
  for (const CycleRecord& record : log.records) {
    comparison.add(record, replayer.replay(record));
    largest_N = std::max(largest_N, record.force_contact_N);
  }
  EXPECT_GT(largest_N, 1.0) << "no contact: this test is blind";
  EXPECT_EQ(comparison.differingCycles(), 0)
      << comparison.first()->column << " in cycle " << comparison.first()->cycle;
  Replayer deaf(controller, 9, scene.period_s);
  ReplayComparison other({9, 3});
  for (CycleRecord record : log.records) {
    record.gains = scene.controller.gains;
    other.add(record, deaf.replay(record));
  }
  EXPECT_GT(other.differingCycles(), 1000) << "the gains make no difference: this test is blind";
}

/// With an e-stop at `stop`, and in each cycle other gains than in the one before.
std::vector<CycleRecord> restlessRun(const Scene& scene, int stop) {
  test::VirtualRobotCell cell(scene);
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  std::vector<CycleRecord> records{cell.record()};
  Gains gains = scene.controller.gains;
  for (int i = 0; i < stop + 1000; ++i) {
    cell.input.lines.emergency_stop = i >= stop && i < stop + 10;
    cell.input.lines.enable = i < stop || i >= stop + 200;
    gains.joint_limit_avoidance.gain = i % 2 == 0 ? 1.0 : 0.9;
    cell.cycle.tune(gains);
    cell.cycle.prepare();
    cell.step();
    records.push_back(cell.record());
  }
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
  return records;
}

/// Until it has moved, an arm that goes on knows its way out of joint limits' zones by where it
/// stands: with the gains of each cycle. Without contact that is seen in the first cycle of motion,
/// in contact before.
TEST(TunedCycle, ReplaysToTheBitWhereGainsChangeWhileTheArmIsStoppedAndGoesOn) {
  const std::pair<const char*, int> runs[] = {{"scenario1_multi_space", 1000},
                                              {"whole_arm/crops9_skin_two_links", 8000}};
  for (const auto& [name, stop] : runs) {
    Scene scene = test::shippedScene(name);
    scene.hardware->gpio.emplace();
    scene.hardware->gpio->enable.emplace();
    scene.hardware->gpio->e_stop.emplace();
    const Controller controller(scene.controller);
    const auto modules = static_cast<int>(scene.controller.tactile_modules.size());
    Replayer replayer(controller, 9, scene.period_s);
    ReplayComparison comparison({9, 3, false, modules});
    for (const CycleRecord& record : restlessRun(scene, stop))
      comparison.add(record, replayer.replay(record));
    EXPECT_EQ(comparison.differingCycles(), 0)
        << name << " " << comparison.first()->column << " in cycle " << comparison.first()->cycle;
  }
}

}  // namespace
}  // namespace tactus
