#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "support/virtual_robot_cell.h"
#include "tactus/record/run_summary.h"
#include "tactus/record/tool_error.h"
#include "tactus/run/simulation.h"

/// The daemon's cycle against the plant on buses of bit time.
namespace tactus {
namespace {

constexpr int kPhases = 4;  // the module samples each four cycles

/// phase: cycles that the enable line waits, so that samples fall into others of the motion.
RunFigures runOnBuses(Scene scene, int phase, int cycles) {
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  test::VirtualRobotCell cell(scene);
  cell.input.lines.enable = false;
  EXPECT_TRUE(cell.runUntil(Mode::kReady, 5000)) << faultName(cell.cycle.report().fault);
  for (int i = 0; i < phase; ++i) cell.step();
  cell.input.lines.enable = true;
  RunSummary summary(scene.controller, 0);
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000)) << faultName(cell.cycle.report().fault);
  for (int i = 0; i < cycles; ++i) {
    CycleRecord record = cell.record();
    fillToolError(scene.controller, record);
    summary.add(record);
    EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning)
        << i << ": " << faultName(cell.cycle.report().fault);
    if (cell.cycle.report().mode != Mode::kRunning) break;
    cell.step();
  }
  EXPECT_EQ(cell.plant.counters().stale_setpoints_applied, 0u);
  return summary.figures();
}

class SceneOnBuses : public testing::TestWithParam<const char*> {};

/// Sensor and drives each answer a cycle later than in the simulation. The estimate of stiffness
/// divides force by way, so it also depends on the cycles in which the module samples.
TEST_P(SceneOnBuses, HasTheForcesOfTheSimulation) {
  const Scene scene = test::shippedScene(GetParam());
  const test::TemporaryFile log(GetParam());
  const RunFigures expected = simulate(scene, log.path(), [](double) {}).figures;
  const auto& force_control = scene.controller.force_control;
  const bool is_estimated = force_control && force_control->has_estimator;
  const double share = is_estimated ? 0.035 : 0.005;
  for (int phase = 0; phase < (is_estimated ? kPhases : 1); ++phase) {
    const RunFigures figures = runOnBuses(scene, phase, 13000);
    EXPECT_NEAR(figures.peak_force_N, expected.peak_force_N, share * expected.peak_force_N);
    EXPECT_NEAR(figures.final_force_N, expected.final_force_N, 0.005 * expected.final_force_N);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SceneOnBuses,
                         testing::Values("free_motion", "scenario1_none", "scenario1_null_space",
                                         "scenario1_joint_space", "scenario1_multi_space",
                                         "scenario2_assumed", "scenario2_estimated",
                                         "scenario3_assumed", "scenario3_estimated",
                                         "scenario3_estimated_fast"),
                         [](const auto& scene) { return scene.param; });

}  // namespace
}  // namespace tactus
