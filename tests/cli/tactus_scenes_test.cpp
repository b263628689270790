#include <gtest/gtest.h>

#include <cmath>

#include "support/telemetry.h"
#include "tactus/run/simulation.h"
#include "tactus/scene/scene_loader.h"

/// The scenes with the approach-speed limit: the three scenarios without a blow.
namespace tactus {
namespace {

constexpr double kGoal_N = 5.0;  // F_act + F_th

RunFigures runScene(const std::string& scene, const std::string& log,
                    const std::vector<Override>& overrides = {}) {
  const std::string path = std::string(TACTUS_SOURCE_DIR) + "/config/scenes/" + scene + ".yaml";
  return simulate(loadScene(path, overrides), log, [](double) {}).figures;
}

struct ScenePeaks {
  std::string scene;
  double peak_force_N, tcp_error_final_m;
};

void PrintTo(const ScenePeaks& expectation, std::ostream* out) { *out << expectation.scene; }

class TactusScene : public testing::TestWithParam<ScenePeaks> {};

TEST_P(TactusScene, NeverSlamsAndRestsAtTheActivationForce) {
  const test::TemporaryFile log(GetParam().scene);
  const RunFigures figures = runScene(GetParam().scene, log.path());
  EXPECT_EQ(figures.end.fault, Fault::kNone);
  EXPECT_LT(figures.peak_force_N, GetParam().peak_force_N);
  EXPECT_NEAR(figures.final_force_N, kGoal_N, 0.01);
  EXPECT_NEAR(figures.tcp_error_final_m, GetParam().tcp_error_final_m, 1e-3)
      << "that of the paper's law";
  EXPECT_EQ(figures.joints_at_limit_cycles, 0);
}

INSTANTIATE_TEST_SUITE_P(All, TactusScene,
                         testing::Values(ScenePeaks{"scenario1_tactus", 5.01, 0.0633},
                                         ScenePeaks{"scenario2_tactus", 5.15, 0.0788},
                                         ScenePeaks{"scenario3_tactus", 5.02, 0.0702},
                                         ScenePeaks{"scenario3_tactus_fast", 5.02, 0.0702}),
                         [](const auto& instance) { return instance.param.scene; });

/// On the arm with gears and a cover: the module that tells M_x needs no friction_coefficient.
TEST(TactusScenes, AModuleThatTellsMomentXBearsFrictionAlone) {
  const auto run = [](const std::vector<Override>& overrides) {
    const Scene scene =
        loadScene(TACTUS_SOURCE_DIR "/config/scenes/real/real_scenario3_mx.yaml", overrides);
    EXPECT_EQ(scene.controller.force_control->friction_coefficient, 0.0);
    return simulate(scene, [](const CycleRecord&) {}).figures;
  };
  for (const char* noise_N : {"0", "0.025"}) {  // of a channel: 0.05 N and 2.1 mNm
    const RunFigures figures = run({{"simulation.tactile_module.noise_N", noise_N}});
    EXPECT_EQ(figures.end.fault, Fault::kNone);
    EXPECT_LT(figures.peak_force_N, 5.25);
    EXPECT_NEAR(figures.final_force_N, kGoal_N, 0.05);
  }
  const RunFigures without =
      run({{"robot", TACTUS_SOURCE_DIR "/config/robots/crops9/robot_real.yaml"}});
  EXPECT_EQ(without.end.fault, Fault::kTactileInvalid) << "this test is blind";
}

/// The last time at which the tool was further than 5 mm from its path.
double lastAway_s(const std::string& log) {
  std::ifstream in = openLog(log);
  UlogReader reader(in, log);
  CycleRecord record;
  double last_s = 0.0;
  while (reader.next(record)) {
    const double error_m =
        std::hypot(record.tool_error_m[0], record.tool_error_m[1], record.tool_error_m[2]);
    if (error_m > 5e-3) last_s = record.t_s;
  }
  return last_s;
}

TEST(TactusScenes, TheToolIsBackSoonAfterTheObstacleHasGone) {
  const std::string profile =
      "{x_m: 0.65413, y_m: 0.06351, stiffness_N_per_m: 17000, vanishes_s: 13, foam: "
      "[{stiffness_N_per_m: 1400, until_force_N: 9}, {stiffness_N_per_m: 1800, until_force_N: "
      "16}]}";
  const std::string band1 = "{x_m: 0.70771, y_m: 0.00265, stiffness_N_per_m: 60, vanishes_s: 13}";
  const std::string band2 = "{x_m: 0.70333, y_m: -0.07897, stiffness_N_per_m: 30, vanishes_s: 13}";
  const std::pair<const char*, std::string> cases[] = {
      {"scenario1_tactus", "[" + band1 + "]"},
      {"scenario2_tactus", "[" + band2 + ", " + profile + "]"},
      {"scenario3_tactus", "[" + profile + "]"},
      {"scenario3_tactus_fast", "[" + profile + "]"}};
  for (const auto& [scene, obstacles] : cases) {
    const test::TemporaryFile log(scene);
    runScene(scene, log.path(),
             {{"simulation.obstacles", obstacles}, {"simulation.duration_s", "16"}});
    const double away_s = lastAway_s(log.path()) - 13.0;
    EXPECT_GT(away_s, 0.3) << scene;
    EXPECT_LT(away_s, 0.8) << scene;
  }
}

TEST(TactusScenes, AWrongModelOfDrivesAndFilterDoesNotMakeItBounce) {
  for (const char* lag : {"0", "0.015"}) {
    for (const char* cutoff : {"10", "25"}) {
      const test::TemporaryFile log(std::string(lag) + "_" + cutoff);
      const RunFigures figures = runScene("scenario2_tactus", log.path(),
                                          {{"simulation.drive_lag_s", lag},
                                           {"simulation.tactile_module.filter_cutoff_hz", cutoff}});
      EXPECT_LT(figures.peak_force_N, 5.6) << lag << " s, " << cutoff << " Hz";
      EXPECT_NEAR(figures.final_force_N, kGoal_N, 0.02) << lag << " s, " << cutoff << " Hz";
    }
  }
}

}  // namespace
}  // namespace tactus
