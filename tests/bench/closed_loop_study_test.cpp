#include "tactus/bench/closed_loop_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

std::string scenePath(const std::string& name) {
  return std::string(TACTUS_SOURCE_DIR) + "/config/scenes/" + name + ".yaml";
}

Scene load(const std::string& name, const std::vector<Override>& overrides = {}) {
  return loadScene(scenePath(name), overrides, SceneUse::kSimulation);
}

std::vector<double> wave(double amplitude, double frequency_Hz, double step_s, int count) {
  std::vector<double> values(count);
  for (int i = 0; i < count; ++i)
    values[i] = 5.0 + amplitude * std::sin(2.0 * M_PI * frequency_Hz * i * step_s + 0.1);
  return values;
}

TEST(Ripple, IsDeviationAndFrequency) {
  const Ripple ripple = rippleOf(wave(0.2, 8.0, 0.001, 2000), 0.001);
  EXPECT_NEAR(ripple.deviation, 0.2 / std::sqrt(2.0), 1e-3);
  EXPECT_NEAR(ripple.frequency_Hz, 8.0, 0.5);
  EXPECT_EQ(rippleOf({}, 0.001).deviation, 0.0);
  EXPECT_EQ(rippleOf({3.0, 3.0, 3.0}, 0.001).deviation, 0.0);
}

TEST(Ripple, IsNoSlowSettling) {
  std::vector<double> values = wave(0.2, 8.0, 0.001, 2000);
  const double level = rippleOf(values, 0.001).deviation;
  for (int i = 0; i < 2000; ++i) values[i] += 0.01 * i;
  EXPECT_NEAR(rippleOf(values, 0.001).deviation, level, 1e-9);
}

TEST(RmsDifference, GoesAsFarAsBothDo) {
  EXPECT_DOUBLE_EQ(rmsDifference({1.0, 2.0, 9.0}, {1.0, 4.0}), std::sqrt(2.0));
  EXPECT_TRUE(std::isnan(rmsDifference({}, {1.0})));
}

TEST(LoopRun, ConvergesWithTheCycle) {
  const Scene scene = load("free_motion", {{"simulation.duration_s", "3"}});
  const LoopRun reference = runWithPeriod(scene, 0.000125);
  ASSERT_EQ(reference.outcome, "stable");
  ASSERT_EQ(reference.tool_error_m.size(), 750u);
  double before = 1e9;
  for (const double period_s : {0.004, 0.002, 0.001}) {
    const LoopRun run = runWithPeriod(scene, period_s);
    ASSERT_EQ(run.tool_error_m.size(), 750u);
    const double difference = rmsDifference(run.tool_error_m, reference.tool_error_m);
    EXPECT_LT(difference, 0.6 * before) << period_s;
    before = difference;
    EXPECT_GT(run.control_time_s, 0.0);
    EXPECT_GT(run.run_time_s, 0.0);
  }
}

/// Assumed far too soft, the loop on a stiff profile never comes to rest.
TEST(LoopRun, TellsALimitCycleFromRest) {
  EXPECT_EQ(runWithPeriod(load("scenario3_assumed"), 0.001).outcome, "stable");
  const LoopRun run =
      runWithPeriod(load("scenario3_assumed", {{"stiffness.assumed_N_per_m", "200"}}), 0.001);
  EXPECT_EQ(run.outcome, "limit cycle");
  EXPECT_GT(run.ripple_N, kMaxRipple_N);
  EXPECT_GT(run.ripple_Hz, 1.0);
}

TEST(LoopRun, NamesWhatTheLoaderRefuses) {
  EXPECT_EQ(refusedKey(scenePath("scenario1_joint_space"), 0.004), "controller.pull_gain_per_s");
  EXPECT_EQ(refusedKey(scenePath("scenario1_joint_space"), 0.0005), "") << "no bus in a simulation";
}

TEST(MeasureLoops, HasARowForEachPeriodAndOneForStability) {
  LoopSizes sizes;
  sizes.reference_period_s = 0.0005;
  sizes.periods_s = {0.001, 0.002};
  sizes.longest_period_s = 0.004;
  const LoopTables tables =
      measureLoops({scenePath("scenario1_joint_space"), scenePath("free_motion")}, sizes);
  EXPECT_EQ(tables.runs.rows.size(), 6u);
  EXPECT_EQ(tables.runs.word(0, "scene"), "scenario1_joint_space");
  EXPECT_TRUE(std::isnan(tables.runs.number(0, "force_rms_to_reference_N")));
  EXPECT_GT(tables.runs.number(1, "force_rms_to_reference_N"), 0.0);
  EXPECT_EQ(tables.stability.number(0, "refused_from_ms"), 3.0);
  EXPECT_EQ(tables.stability.word(0, "refused_key"), "controller.pull_gain_per_s");
  EXPECT_EQ(tables.stability.number(1, "longest_stable_period_ms"), 4.0);
  EXPECT_THROW(measureLoops({"gone.yaml"}, sizes), InputError);
}

}  // namespace
}  // namespace tactus
