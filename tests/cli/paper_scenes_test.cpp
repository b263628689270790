#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/record/replay.h"
#include "tactus/run/simulation.h"
#include "tactus/scene/scene_loader.h"

/// The scenes as they are shipped, against the independent reference (within 1 % where the law is
/// the same) and against the paper.
namespace tactus {
namespace {

constexpr double kShare = 0.01;
constexpr double kAny = -1.0;

struct Expectation {
  std::string scene;
  double peak_force_N, final_force_N, tcp_error_final_m, tcp_error_max_m;
};

void PrintTo(const Expectation& expectation, std::ostream* out) { *out << expectation.scene; }

RunFigures run(const std::string& scene, const std::string& log,
               const std::vector<Override>& overrides = {}) {
  return simulate(test::shippedScene(scene, overrides), log, [](double) {}).figures;
}

void expectNear(double value, double expected, const char* what) {
  if (expected == kAny) return;
  EXPECT_NEAR(value, expected, kShare * expected) << what;
}

class PaperScene : public testing::TestWithParam<Expectation> {};

TEST_P(PaperScene, AgreesWithReference) {
  const test::TemporaryFile log(GetParam().scene);
  const RunFigures figures = run(GetParam().scene, log.path());
  EXPECT_EQ(figures.cycles, 13000);
  EXPECT_EQ(figures.end.fault, Fault::kNone);
  EXPECT_EQ(figures.joints_at_limit_cycles, 0);
  expectNear(figures.peak_force_N, GetParam().peak_force_N, "peak force, N");
  expectNear(figures.final_force_N, GetParam().final_force_N, "final force, N");
  expectNear(figures.tcp_error_final_m, GetParam().tcp_error_final_m, "final TCP error, m");
  if (GetParam().tcp_error_max_m != kAny) {
    EXPECT_LT(figures.tcp_error_max_m, GetParam().tcp_error_max_m);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, PaperScene,
    testing::Values(Expectation{"free_motion", kAny, kAny, kAny, 4e-4},
                    Expectation{"scenario1_none", kAny, 10.11, kAny, 4e-4},
                    Expectation{"scenario1_null_space", kAny, 6.80, kAny, 4e-4},
                    Expectation{"scenario1_weighted", kAny, 6.80, kAny, 4e-4},
                    Expectation{"scenario1_multi_space", 6.70, 5.82, 0.035, kAny},
                    Expectation{"scenario1_null_joint", 6.70, 5.82, kAny, kAny},
                    Expectation{"scenario2_assumed", 18.0, 5.0, 0.079, kAny},
                    Expectation{"scenario2_estimated", 8.9, 5.0, 0.079, kAny},
                    Expectation{"scenario3_assumed", 17.7, 5.0, kAny, kAny},
                    Expectation{"scenario3_estimated", 8.0, 5.0, kAny, kAny},
                    Expectation{"scenario3_estimated_fast", 12.8, 5.0, kAny, kAny}),
    [](const auto& instance) { return instance.param.scene; });

TEST(PaperScenes, EstimateTheStiffnessOfTheReference) {
  const test::TemporaryFile slow_log(".slow");
  const test::TemporaryFile fast_log(".fast");
  const RunFigures slow = run("scenario3_estimated", slow_log.path());
  const RunFigures fast = run("scenario3_estimated_fast", fast_log.path());
  expectNear(slow.stiffness_at_peak_N_per_m, 1618.0, "slow, N/m");
  expectNear(fast.stiffness_at_peak_N_per_m, 2053.0, "fast, N/m");
}

/// Largest and last deviation of the tool between two times, from a log.
double largestToolError_m(const std::string& log, double from_s, double to_s) {
  std::ifstream in = openLog(log);
  UlogReader reader(in, log);
  CycleRecord record;
  double largest = 0.0;
  while (reader.next(record)) {
    if (record.t_s < from_s || record.t_s > to_s) continue;
    largest = std::max(largest, std::hypot(record.tool_error_m[0], record.tool_error_m[1],
                                           record.tool_error_m[2]));
  }
  return largest;
}

TEST(PaperScenes, JointSpaceRestsWhereThePaperDoes) {
  const test::TemporaryFile log;
  const RunFigures figures = run("scenario1_joint_space", log.path());
  EXPECT_EQ(figures.end.fault, Fault::kNone);
  EXPECT_NEAR(figures.final_force_N, 0.7, 0.2);
  EXPECT_EQ(figures.joints_at_limit_cycles, 0);
  EXPECT_LT(figures.peak_joint_speed_squared, 25.0);
}

TEST(PaperScenes, JointSpaceReturnsWhenTheBandVanishes) {
  const test::TemporaryFile log;
  const RunFigures figures =
      run("scenario1_joint_space", log.path(),
          {{"simulation.obstacles",
            "[{x_m: 0.70771, y_m: 0.00265, stiffness_N_per_m: 60, vanishes_s: 10}]"},
           {"simulation.duration_s", "16"}});
  EXPECT_EQ(figures.end.fault, Fault::kNone);
  EXPECT_EQ(figures.joints_at_limit_cycles, 0);
  EXPECT_LT(figures.peak_joint_speed_squared, 25.0);
  EXPECT_LT(largestToolError_m(log.path(), 13.0, 16.0), 1e-3);
}

class ReplayOfScene : public testing::TestWithParam<std::string> {};

TEST_P(ReplayOfScene, ReproducesEveryOutputToTheBit) {
  const test::TemporaryFile log;
  run(GetParam(), log.path());
  std::ifstream in = openLog(log.path());
  UlogReader reader(in, log.path());
  const LogDescription& description = reader.description();
  const Scene scene = loadScene(description.sources, description.overrides);
  const Controller controller(scene.controller);
  Replayer replayer(controller, description.shape.joints, scene.period_s);
  ReplayComparison comparison(description.shape);
  CycleRecord record;
  while (reader.next(record)) comparison.add(record, replayer.replay(record));
  EXPECT_EQ(comparison.cycles(), std::llround(scene.duration_s / scene.period_s));
  EXPECT_EQ(comparison.differingCycles(), 0);
}

std::vector<std::string> allScenes() {
  const std::filesystem::path folder = std::string(TACTUS_SOURCE_DIR) + "/config/scenes";
  std::vector<std::string> names;
  for (const char* part : {"", "robots"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder / part)) {
      if (entry.path().extension() == ".yaml")
        names.push_back((part / entry.path().stem()).string());
    }
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, ReplayOfScene, testing::ValuesIn(allScenes()),
                         [](const auto& instance) {
                           return std::filesystem::path(instance.param).filename().string();
                         });

}  // namespace
}  // namespace tactus
