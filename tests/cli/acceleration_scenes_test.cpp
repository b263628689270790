#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/shipped_scene.h"
#include "tactus/run/simulation.h"

/// The shipped scenes at both levels.
namespace tactus {
namespace {

struct LevelRun {
  RunFigures figures;
  double jerk_rms = 0.0, jerk_peak = 0.0;  ///< second difference of the command, all joints
};

LevelRun runAtLevel(const std::string& name, const char* level,
                    std::vector<Override> overrides = {}) {
  overrides.push_back({"controller.level", level});
  const Scene scene = test::shippedScene(name, overrides);
  const int joints = scene.controller.chain.size();
  LevelRun run;
  CycleRecord before, two_before;
  double sum = 0.0;
  int cycles = 0;
  run.figures = simulate(scene, [&](const CycleRecord& record) {
                  if (cycles++ >= 2) {
                    double squared = 0.0;
                    for (int i = 0; i < joints; ++i) {
                      const double change = record.dq[i] - 2.0 * before.dq[i] + two_before.dq[i];
                      squared += change * change;
                    }
                    sum += squared;
                    run.jerk_peak = std::max(run.jerk_peak, std::sqrt(squared));
                  }
                  two_before = before;
                  before = record;
                }).figures;
  run.jerk_rms = std::sqrt(sum / cycles);
  return run;
}

class BothLevels : public testing::TestWithParam<const char*> {};

TEST_P(BothLevels, PeakAndRestAlikeAndTheSecondIsSmoother) {
  const LevelRun velocity = runAtLevel(GetParam(), "velocity");
  const LevelRun acceleration = runAtLevel(GetParam(), "acceleration");
  EXPECT_EQ(acceleration.figures.end.fault, Fault::kNone);
  EXPECT_EQ(acceleration.figures.joints_at_limit_cycles, 0);
  const double peak_N = velocity.figures.peak_force_N;
  EXPECT_LE(acceleration.figures.peak_force_N, 1.02 * peak_N);
  EXPECT_GE(acceleration.figures.peak_force_N, 0.95 * peak_N) << "it gives way another way";
  EXPECT_NEAR(acceleration.figures.final_force_N, velocity.figures.final_force_N, 0.01);
  EXPECT_NEAR(acceleration.figures.tcp_error_final_m, velocity.figures.tcp_error_final_m, 1e-3);
  EXPECT_LT(acceleration.jerk_rms, 0.25 * velocity.jerk_rms);
  EXPECT_LT(acceleration.jerk_peak, 0.5 * velocity.jerk_peak);
}

INSTANTIATE_TEST_SUITE_P(All, BothLevels,
                         testing::Values("scenario1_null_space", "scenario1_weighted",
                                         "scenario1_tactus", "scenario2_estimated",
                                         "scenario2_tactus", "scenario3_estimated",
                                         "scenario3_estimated_fast", "scenario3_tactus",
                                         "scenario3_tactus_fast"),
                         [](const auto& instance) { return std::string(instance.param); });

/// A contact much softer than assumed creeps: lower peaks, the same rest, later.
TEST(BothLevelsAsAssumed, RestAlikeInTheEndAndTheSecondPeaksLower) {
  for (const char* name : {"scenario1_multi_space", "scenario2_assumed", "scenario3_assumed"}) {
    const std::vector<Override> longer = {{"simulation.duration_s", "60"}};
    const LevelRun velocity = runAtLevel(name, "velocity", longer);
    const LevelRun acceleration = runAtLevel(name, "acceleration", longer);
    EXPECT_LT(acceleration.figures.peak_force_N, 0.9 * velocity.figures.peak_force_N) << name;
    EXPECT_NEAR(acceleration.figures.final_force_N, velocity.figures.final_force_N, 0.05) << name;
    EXPECT_LT(acceleration.jerk_rms, 0.25 * velocity.jerk_rms) << name;
  }
}

}  // namespace
}  // namespace tactus
