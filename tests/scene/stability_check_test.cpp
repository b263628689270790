#include "tactus/scene/stability_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "support/hardware_files.h"
#include "support/scene_files.h"
#include "support/shipped_scene.h"

/// The scene of SceneFiles: both spaces, estimated, assumed 7000 N/m, arm 5000 N/m, drives 10 ms, a
/// sample every 5 ms.
namespace tactus {
namespace {

using test::BrokenText;
using test::SceneFiles;

const std::string kEstimate = "  estimate: {min_N_per_m: 20}\n";

/// Without estimate, and with what `more` says of the stiffness.
SceneFiles assumed(const std::string& more = "") {
  SceneFiles files;
  files.scene = test::replaced(files.scene, kEstimate, more.empty() ? "" : "  " + more + "\n");
  return files;
}

/// With drives and samples as quick as the paper's.
SceneFiles quick(SceneFiles files) {
  files.robot = test::replaced(files.robot, "position_lag_s: 0.01", "position_lag_s: 0.005");
  files.robot = test::replaced(files.robot, "sample_period_s: 0.005", "sample_period_s: 0.004");
  return files;
}

std::string stabilityError(const Scene& scene) {
  try {
    checkStability(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

StabilityReport check(const Scene& scene) {
  StabilityReport report = checkStability(scene).value();
  addGearMargins(scene, report);
  return report;
}

/// Largest c_e / c of the least stable loop.
double largestRatio(const StabilityReport& report) {
  double largest = kNoLimit;
  for (const LoopReport& loop : report.loops)
    largest = std::min(largest, loop.margins.largest_stiffness_ratio);
  return largest;
}

TEST(StabilityCheck, HasNothingToSayWithoutForceControl) {
  EXPECT_FALSE(checkStability(SceneFiles{}.load({{"controller.variant", "none"}})));
  EXPECT_FALSE(checkStability(SceneFiles{}.load({{"controller", "null"}, {"stiffness", "null"}})));
}

TEST(StabilityCheck, TakesItsNumbersFromSceneAndRobot) {
  const Scene scene = assumed().load();
  const StabilityReport report = check(scene);
  ContactLoop expected;
  expected.law = LoopLaw::kTwoSpaces;
  expected.drive_lag_s = 0.01;
  expected.sample_period_s = 0.005;
  EXPECT_EQ(report.loops.at(0).margins.largest_stiffness_ratio,
            computeMargins(expected, 1.0).largest_stiffness_ratio);
  expected.drift_gain_per_s = 5.0;
  EXPECT_EQ(report.loops.at(1).margins.phase_margin_rad,
            computeMargins(expected, 1.0).phase_margin_rad);
}

TEST(StabilityCheck, LooksAtTheLoopsOfTheVariant) {
  const auto loops = [](const std::string& variant) {
    std::vector<Override> settings = {{"controller.variant", variant}};
    if (variant == "joint_space") settings.push_back({"redundancy.joint_limit_avoidance", "{}"});
    return check(assumed().load(settings)).loops.size();
  };
  EXPECT_EQ(loops("null_space"), 1u);
  EXPECT_EQ(loops("joint_space"), 1u);
  EXPECT_EQ(loops("task_space"), 2u);
  EXPECT_EQ(loops("null_task"), 3u);
  EXPECT_EQ(loops("null_joint"), 3u);
  EXPECT_EQ(loops("null_limit"), 2u);
}

TEST(StabilityCheck, TakesTheLoopsOfTheAccelerationLevel) {
  const StabilityReport report = check(assumed().load({{"controller.level", "acceleration"}}));
  ASSERT_EQ(report.loops.size(), 3u);
  ContactLoop expected;
  expected.is_acceleration = true;
  expected.drive_lag_s = 0.01;
  expected.sample_period_s = 0.005;
  EXPECT_EQ(report.loops.at(2).margins.phase_margin_rad,
            computeMargins(expected, 1.0).phase_margin_rad);
  expected.law = LoopLaw::kTwoSpaces;
  EXPECT_EQ(report.loops.at(0).margins.largest_stiffness_ratio,
            computeMargins(expected, 1.0).largest_stiffness_ratio);
  expected.drift_gain_per_s = 5.0;
  EXPECT_EQ(report.loops.at(1).margins.largest_stiffness_ratio,
            computeMargins(expected, 1.0).largest_stiffness_ratio);
}

TEST(StabilityCheck, TakesTheApproachLimitWithTheModelThatItHas) {
  const StabilityReport report = check(
      assumed().load({{"controller.variant", "null_limit"}, {"simulation.drive_lag_s", "0.02"}}));
  ContactLoop expected;
  expected.law = LoopLaw::kApproachLimit;
  expected.order = 1;
  expected.drive_lag_s = 0.02;
  expected.model_drive_lag_s = 0.01;
  expected.sample_period_s = 0.005;
  EXPECT_EQ(report.loops.at(1).margins.largest_stiffness_ratio,
            computeMargins(expected, 1.0).largest_stiffness_ratio);
}

TEST(StabilityCheck, TakesTheContactForAsStiffAsAssumed) {
  const StabilityReport report = check(assumed().load());
  EXPECT_EQ(report.stiffest_N_per_m, 7000.0);
  EXPECT_EQ(report.ratio(), 1.0);
}

TEST(StabilityCheck, TakesTheDeclaredStiffnessInstead) {
  EXPECT_EQ(check(assumed("stiffest_N_per_m: 10500").load()).ratio(), 1.5);
  EXPECT_EQ(check(assumed("stiffest_N_per_m: 3500").load()).stiffest_N_per_m,
            1.0 / (1.0 / 17000.0 + 1.0 / 5000.0))
      << "an obstacle of the scene is stiffer";
}

TEST(StabilityCheck, RefusesAContactThatIsTooStiff) {
  const double largest = largestRatio(check(quick(assumed()).load()));
  const auto error = [&](double ratio) {
    const std::string stiffest = "stiffest_N_per_m: " + std::to_string(ratio * 7000.0);
    return stabilityError(quick(assumed(stiffest)).load());
  };
  EXPECT_EQ(error(0.999 * largest), "");
  test::expectError(error(1.001 * largest),
                    {"", "", "scene.yaml:16:21: stiffness.stiffest_N_per_m: ",
                     "unstable (both spaces) in a contact of 1", "at most "});
}

/// The number behind `words` in an error.
std::string numberAfter(const std::string& error, const std::string& words) {
  const std::size_t at = error.find(words);
  EXPECT_NE(at, std::string::npos) << error;
  const std::size_t start = at + words.size();
  return error.substr(start, error.find(' ', start) - start);
}

TEST(StabilityCheck, NamesStiffnessesThatDoWithoutWarning) {
  const auto scene = [](const std::string& stiffest, const std::string& assumed_N_per_m) {
    return quick(assumed("stiffest_N_per_m: " + stiffest))
        .load({{"stiffness.assumed_N_per_m", assumed_N_per_m}});
  };
  const std::string error = stabilityError(scene("60000", "7000"));
  const std::string softer = numberAfter(error, "at most ");
  const std::string stiffer = numberAfter(error, "assumed_N_per_m of at least ");
  EXPECT_NE(error.find("for a phase margin of 30 degrees"), std::string::npos) << error;
  EXPECT_EQ(check(scene(softer, "7000")).warnings, std::vector<std::string>{}) << softer;
  EXPECT_EQ(check(scene("60000", stiffer)).warnings, std::vector<std::string>{}) << stiffer;
}

TEST(StabilityCheck, NamesATimeConstantWhereNoStiffnessHasTheMargin) {
  const auto scene = [](const std::string& T_s) {
    return assumed("stiffest_N_per_m: 60000").load({{"controller.time_constant_s", T_s}});
  };
  const std::string error = stabilityError(scene("0.1"));
  EXPECT_NE(error.find(": controller.time_constant_s: 0.1 s is unstable "), std::string::npos)
      << error;
  EXPECT_EQ(check(scene(numberAfter(error, "at least "))).warnings, std::vector<std::string>{});
}

/// What may be met is no softer than what the law takes it for: more stiffness would not help.
TEST(StabilityCheck, NamesATimeConstantWhereTheStiffnessThatIsTakenHasNotTheMargin) {
  const auto scene = [](const std::string& T_s) {
    return quick(assumed()).load(
        {{"controller.time_constant_s", T_s}, {"stiffness.assumed_N_per_m", "500"}});
  };
  const std::string error = stabilityError(scene("0.08"));
  EXPECT_NE(error.find(": controller.time_constant_s: 0.08 s is unstable "), std::string::npos)
      << error;
  EXPECT_EQ(check(scene(numberAfter(error, "at least "))).warnings, std::vector<std::string>{});
}

TEST(StabilityCheck, NamesTheEdgeWhereDampingAllowsNoMargin) {
  const auto scene = [](const std::string& T_s) {
    return assumed().load({{"controller.damping", "0.1"}, {"controller.time_constant_s", T_s}});
  };
  const std::string error = stabilityError(scene("0.1"));
  EXPECT_NE(error.find("more damping"), std::string::npos) << error;
  EXPECT_EQ(check(scene(numberAfter(error, "at least "))).warnings.size(), 1u) << error;
}

TEST(StabilityCheck, RefusesAnObstacleThatIsTooStiff) {
  test::expectError(stabilityError(quick(assumed()).load({{"stiffness.assumed_N_per_m", "500"}})),
                    {"", "", "scene.yaml:20:47: simulation.obstacles[1].stiffness_N_per_m: ",
                     "in a contact of 3863.64 N/m, obstacle and arm in series", "at most "});
}

TEST(StabilityCheck, RefusesGainsThatAreUnstableAsAssumedAndNamesThoseThatAreNot) {
  const std::string error =
      stabilityError(assumed().load({{"controller.time_constant_s", "0.05"}}));
  test::expectError(error,
                    {"", "", "--set controller.time_constant_s:1:1: controller.time_constant_s: ",
                     "0.05 s is unstable (both spaces) in a contact of 7000 N/m", "at least 0.1"});
  const std::string at_least = numberAfter(error, "at least ");
  EXPECT_EQ(check(assumed().load({{"controller.time_constant_s", at_least}})).warnings,
            std::vector<std::string>{})
      << at_least;
}

TEST(StabilityCheck, ExpectsOfAnEstimateThatItCanFollow) {
  const SceneFiles files = quick({});
  const StabilityReport report = check(files.load({{"stiffness.stiffest_N_per_m", "30000"}}));
  EXPECT_EQ(report.ratio(), 1.0);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("until the estimate has risen from 7000 to "),
            std::string::npos);
  test::expectError(
      stabilityError(files.load({{"stiffness.estimate.max_N_per_m", "2000"}})),
      {"", "", "--set stiffness.estimate.max_N_per_m:1:1: stiffness.estimate.max_N_per_m: ",
       "2000 N/m is unstable (both spaces)", "at least 6"});
}

TEST(StabilityCheck, WarnsBelowThirtyDegrees) {
  const StabilityReport slow_drives = check(assumed().load());
  ASSERT_EQ(slow_drives.warnings.size(), 1u);
  EXPECT_NE(slow_drives.warnings[0].find("phase margin of 2"), std::string::npos);
  EXPECT_EQ(check(quick(assumed()).load()).warnings.size(), 0u);
}

/// Not "30.0 degrees: better 30 or more".
TEST(StabilityCheck, TellsNoMarginThatWouldDoWhereItDoesNot) {
  double low_s = 0.07, high_s = 0.2;
  const auto margin = [](double T_s) {
    return quick(assumed()).load({{"controller.time_constant_s", std::to_string(T_s)}});
  };
  while (high_s - low_s > 2e-6) {
    const double middle_s = 0.5 * (low_s + high_s);
    (phaseMargin_deg(margin(middle_s)) < kMinPhaseMargin_deg ? low_s : high_s) = middle_s;
  }
  const StabilityReport report = check(margin(low_s));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("phase margin of 29.9 degrees"), std::string::npos)
      << report.warnings[0];
}

TEST(StabilityCheck, FindsNothingInTheScenesThatComeAlong) {
  int with_force_control = 0;
  const std::filesystem::path folder = TACTUS_SOURCE_DIR "/config/scenes";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml" || entry.path().parent_path().stem() == "base")
      continue;
    const Scene scene = loadScene(entry.path().string(), {});
    auto report = checkStability(scene);
    if (!report) continue;
    addGearMargins(scene, *report);
    // The profile's solid part, with links and cover but without gears, is 12.6 kN/m.
    const bool is_taken_for_softer = entry.path().stem().string().ends_with("_assumed");
    ASSERT_EQ(report->warnings.size(), is_taken_for_softer ? 1u : 0u) << entry.path();
    if (is_taken_for_softer) {
      EXPECT_NE(report->warnings.front().find("with the arm's gears"), std::string::npos);
    }
    ++with_force_control;
  }
  EXPECT_GT(with_force_control, 10);
}

/// Slow gains with next to no damping are stable in whatever there is.
TEST(StabilityCheck, TellsOfLoopsThatNothingMakesUnstable) {
  const Scene scene =
      assumed().load({{"controller.time_constant_s", "100"}, {"controller.damping", "0.0005"}});
  const StabilityReport report = check(scene);
  ASSERT_FALSE(report.loops.empty());
  EXPECT_EQ(largestRatio(report), kNoLimit);
}

TEST(StabilityCheck, SaysSoWhereMarginsCannotBeComputed) {
  SceneFiles files = assumed();
  files.robot = test::replaced(files.robot, "sample_period_s: 0.005",
                               "sample_period_s: 0.99991\n  filter_rate_hz: 100000\n  "
                               "max_sample_age_s: 1");
  const StabilityReport report = check(files.load());
  EXPECT_TRUE(report.loops.empty());
  EXPECT_EQ(report.warnings.size(), 1u);
}

TEST(StabilityCheck, NamesWhatTheSimulationHasAndNoLoop) {
  const SceneFiles files = quick(assumed());
  const std::size_t before = check(files.load()).warnings.size();
  for (const auto& [key, value] :
       std::vector<Override>{{"drives.dead_time_s", "0.05"},
                             {"drives.bandwidth_hz", "0.05"},
                             {"drives.max_acceleration", "[3, 3, 3]"},
                             {"tactile_module.channel_gains", "[1, 1, 1, 1, 1, 1, 1, 1.2]"},
                             {"tactile_module.direction_error_rad", "-0.1"},
                             {"tactile_module.jitter_s", "0.05"},
                             {"tactile_module.lost_share", "0.05"}}) {
    const StabilityReport report = check(files.load({{"simulation." + key, value}}));
    ASSERT_EQ(report.warnings.size(), before + 1) << key;
    EXPECT_NE(report.warnings.back().find("simulation." + key), std::string::npos);
  }
  const std::vector<Override> exact{
      {"simulation.tactile_module.channel_gains", "[1, 1, 1, 1, 1, 1, 1, 1]"}};
  EXPECT_EQ(check(files.load(exact)).warnings.size(), before);
}

/// As the simulation does: no other filter can be simulated.
TEST(StabilityCheck, TakesTheFilterOfTheDaemonAsItIs) {
  SceneFiles files = test::hardwareFiles();
  const Scene scene = files.load();
  EXPECT_EQ(scene.plant.modules[0].filter_place, FilterPlace::kReader);
  const double ratio = largestRatio(check(scene));
  files.robot = test::replaced(files.robot, "filter_in_daemon: true",
                               "filter_in_daemon: true\n  filter_cutoff_hz: 8");
  EXPECT_LT(largestRatio(check(files.load())), ratio);
}

/// tactusd shall not start with gains that only quicker drives or filters would bear.
TEST(StabilityCheck, TakesNoQuickerDrivesThanTheRobotHasForTheDaemon) {
  SceneFiles files = test::hardwareFiles();
  files.robot = test::replaced(files.robot, "  filter_in_daemon: true\n", "");
  const auto ratio = [&](const std::vector<Override>& settings) {
    return largestRatio(check(files.load(settings)));
  };
  const double of_robot = ratio({});
  EXPECT_EQ(ratio({{"simulation.drive_lag_s", "0"}}), of_robot);
  EXPECT_EQ(ratio({{"simulation.tactile_module.filter_cutoff_hz", "300"}}), of_robot);
  EXPECT_LT(ratio({{"simulation.drive_lag_s", "0.02"}}), of_robot);
  EXPECT_LT(ratio({{"simulation.tactile_module.filter_cutoff_hz", "8"}}), of_robot);
  const SceneFiles simulated = assumed();  // without buses: no daemon runs it
  EXPECT_GT(largestRatio(check(simulated.load({{"simulation.drive_lag_s", "0"}}))),
            largestRatio(check(simulated.load())));
}

TEST(StabilityCheck, TakesTheArmsGearsIntoLoopsOfOneSpace) {
  const StabilityReport report = check(test::shippedScene("scenario1_tactus"));
  ASSERT_EQ(report.loops.size(), 2u);
  for (const LoopReport& loop : report.loops) {
    ASSERT_TRUE(loop.ratio_with_gears) << loop.name;
    EXPECT_LT(*loop.ratio_with_gears, 0.7 * loop.margins.largest_stiffness_ratio) << loop.name;
    EXPECT_GT(*loop.ratio_with_gears, 0.2 * loop.margins.largest_stiffness_ratio) << loop.name;
  }
  EXPECT_NEAR(report.gear_mode_hz.value(), 6.2, 0.1);
  const StabilityReport both = check(test::shippedScene("scenario1_multi_space"));
  EXPECT_FALSE(both.loops.front().ratio_with_gears);
  EXPECT_TRUE(both.loops.back().ratio_with_gears);
}

TEST(StabilityCheck, KnowsNothingOfGearsThatNobodyDescribes) {
  const StabilityReport report = check(assumed().load());
  EXPECT_FALSE(report.gear_mode_hz);
  for (const LoopReport& loop : report.loops) EXPECT_FALSE(loop.ratio_with_gears);
}

/// Stiffer gears come closer and closer to rigid ones, and soft ones stand less.
TEST(StabilityCheck, LosesMarginWithSofterGears) {
  Scene scene = test::shippedScene("scenario1_null_space");
  double before = 0.0;
  for (const double factor : {0.3, 1.0, 10.0, 100.0}) {
    SCOPED_TRACE(factor);
    Scene changed = scene;
    changed.arm->dynamics.gear_stiffness *= factor;
    const LoopReport loop = check(changed).loops.front();
    EXPECT_GT(*loop.ratio_with_gears, before);
    before = *loop.ratio_with_gears;
  }
}

/// It is unstable for c_e / c of 3.12 to 3.65, and then again from 10.6 on.
TEST(StabilityCheck, StepsOverNoIslandWhereGearsMakeTheLoopUnstable) {
  const StabilityReport report =
      check(test::shippedScene("commands", {{"controller.time_constant_s", "0.11"},
                                            {"stiffness.estimate", "~"},
                                            {"simulation.obstacles", "~"},
                                            {"stiffness.stiffest_N_per_m", "22000"},
                                            {"stiffness.assumed_N_per_m", "6573.8"}}));
  const auto limit = std::ranges::find(report.loops, "approach limit", &LoopReport::name);
  ASSERT_NE(limit, report.loops.end());
  EXPECT_GT(limit->ratio_with_gears.value(), 3.1);
  EXPECT_LT(limit->ratio_with_gears.value(), 3.2);
}

TEST(StabilityCheck, WarnsOfGearsTooSoftForTheStiffestContact) {
  Scene scene = test::shippedScene("scenario1_null_space");
  scene.stiffest_N_per_m = 7000.0;
  const auto warns = [](const Scene& checked) {
    return std::ranges::any_of(check(checked).warnings, [](const std::string& warning) {
      return warning.find("with the arm's gears") != std::string::npos;
    });
  };
  EXPECT_FALSE(warns(scene));
  scene.controller.gains.force.time_constant_s = 0.06;
  EXPECT_TRUE(warns(scene));
  scene.stiffest_N_per_m = 0.0;
  EXPECT_FALSE(warns(scene)) << "the obstacle is soft";
  scene.plant.obstacles.clear();
  EXPECT_TRUE(warns(scene)) << "nothing else is said: what is assumed may be met";
}

}  // namespace
}  // namespace tactus
