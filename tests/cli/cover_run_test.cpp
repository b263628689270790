#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/command_run.h"
#include "support/run_folder.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/cli/commands.h"
#include "tactus/run/simulation.h"
#include "tactus/scene/input_error.h"
#include "tactus/scene/json.h"
#include "tactus/scene/path_check.h"

/// Covers that weigh something, from a scene to what its log says of them.
namespace tactus {
namespace {

class CoverRunTest : public ::testing::Test {
 protected:
  void logRun(const std::string& scene, const std::vector<Override>& overrides) const {
    simulate(test::shippedScene(scene, overrides), log_.path(), [](double) {});
  }

  int identify(std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.begin(), {"identify", "cover", log_.path()});
    return test::runCommand(addIdentifyCommand, std::move(arguments), output_);
  }

  std::string refusal() {
    try {
      identify();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryFile log_{".ulg"};
  std::string output_;
};

std::vector<Override> withNoise(std::vector<Override> overrides) {
  overrides.push_back({"simulation.tactile_module.noise_N", "0.05"});
  return overrides;
}

TEST_F(CoverRunTest, IsIdentifiedFromTheLogOfTheShippedScene) {
  for (const char* arm : {"quasi_static", "flexible_gears"}) {
    logRun("robots/crops9_cover", withNoise({{"simulation.tactile_module.cover",
                                              "{mass_kg: 0.4, center_m: [0.2, 0.01, -0.02]}"},
                                             {"simulation.arm", arm}}));
    ASSERT_EQ(identify({"--json"}), kExitDone) << output_;
    const Json found = Json::parse(output_);
    EXPECT_NEAR(found["cover"]["mass_kg"].get<double>(), 0.4, 0.01) << arm;
    const auto center = found["cover"]["center_m"].get<std::vector<double>>();
    EXPECT_NEAR(center[0], 0.2, 0.01);
    EXPECT_NEAR(center[1], 0.01, 0.01);
    EXPECT_NEAR(center[2], -0.02, 0.01);
  }
  EXPECT_EQ(identify(), kExitDone);
  EXPECT_NE(output_.find("\ncover: {mass_kg: 0.4"), std::string::npos) << output_;
}

TEST_F(CoverRunTest, WhatALogDoesNotTellIsRefused) {
  const Override cover{"simulation.tactile_module.cover.mass_kg", "0.4"};
  logRun("robots/crops9_cover",
         {cover,
          {"task.trajectory.waypoints[0].displacement_m", "[0, 0, 0.005]"},
          {"task.trajectory.waypoints[1].displacement_m", "[0, 0, -0.005]"}});
  EXPECT_NE(refusal().find("cover: across the axis of the module gravity changes by"),
            std::string::npos)
      << refusal();
  logRun("robots/crops9_cover", {cover, {"simulation.duration_s", "3"}});
  EXPECT_NE(refusal().find("too short"), std::string::npos) << refusal();
  logRun("robots/crops9_cover", withNoise({}));
  EXPECT_NE(refusal().find("cover: the mass is"), std::string::npos) << refusal();
  logRun("robots/crops9_cover", {});  // not even noise
  EXPECT_NE(refusal().find("cover: the mass is 0"), std::string::npos) << refusal();
  logRun("free_motion", {});
  EXPECT_NE(refusal().find("no tactile module is read"), std::string::npos) << refusal();
}

constexpr const char* kCoverScene = TACTUS_SOURCE_DIR "/config/scenes/robots/crops9_cover.yaml";

/// What identifying with these words prints, or how it refuses to.
std::string identified(std::vector<std::string> words) {
  words.insert(words.begin(), {"identify", "cover"});
  std::string output;
  try {
    EXPECT_EQ(test::runCommand(addIdentifyCommand, std::move(words), output), kExitDone);
  } catch (const InputError& error) {
    return error.what();
  }
  return output;
}

TEST_F(CoverRunTest, ASceneIsIdentifiedAsTheLogOfItsRun) {
  const std::vector<Override> settings = withNoise(
      {{"simulation.tactile_module.cover", "{mass_kg: 0.4, center_m: [0.2, 0.01, -0.02]}"}});
  logRun("robots/crops9_cover", settings);
  ASSERT_EQ(identify({"--json"}), kExitDone) << output_;
  std::vector<std::string> words = {kCoverScene, "--json"};
  for (const Override& setting : settings)
    words.insert(words.end(), {"--set", setting.key + "=" + setting.value});
  const Json of_log = Json::parse(output_);
  Json of_scene = Json::parse(identified(words));
  EXPECT_TRUE(of_log["simulated"].is_null());
  EXPECT_EQ(of_scene["simulated"]["mass_kg"], 0.4);
  EXPECT_EQ(of_scene["simulated"]["center_m"], Json({0.2, 0.01, -0.02}));
  of_scene["simulated"] = nullptr;
  EXPECT_EQ(of_scene, of_log);
  words.erase(words.begin() + 1);
  EXPECT_NE(
      identified(words).find("\nsimulated 0.4000 kg, centre x 0.2000, y 0.0100, z -0.0200 m\n"),
      std::string::npos)
      << identified(words);
}

/// The log of such a run would hold the contact.
TEST_F(CoverRunTest, ASceneTouchesNothing) {
  const std::string cover = "simulation.tactile_module.cover.mass_kg=0.4";
  const std::string post = "simulation.obstacles=[{x_m: 0.65, y_m: 0.06, stiffness_N_per_m: 1e4}]";
  EXPECT_EQ(identified({kCoverScene, "--set", cover, "--set", post}),
            identified({kCoverScene, "--set", cover}));
}

TEST_F(CoverRunTest, WhatASceneDoesNotTellIsRefused) {
  const auto expectRefusal = [](const std::vector<std::string>& words, const char* problem) {
    const std::string text = identified(words);
    EXPECT_NE(text.find(problem), std::string::npos) << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 0) << text;
  };
  const std::string mass = "simulation.tactile_module.cover.mass_kg=";
  expectRefusal({kCoverScene}, "crops9_cover.yaml:1:1: cover: the simulated module has none");
  expectRefusal({kCoverScene, "--set", mass + "0.4", "--set", "simulation.duration_s=3"},
                "too short");
  expectRefusal({kCoverScene, "--set", mass + "0.4", "--module", "1"}, "no tactile module 1");
  EXPECT_THROW(identified({kCoverScene, "--module", "-1"}), CLI::ValidationError);
  EXPECT_THROW(identified({kCoverScene, "--module", "8"}), CLI::ValidationError);
  expectRefusal({kCoverScene, "--set", mass + "60"}, "the run ends by tactile_saturated");
  expectRefusal({kCoverScene, "--set", mass}, "simulation.tactile_module.cover.mass_kg");
  expectRefusal({std::string(kCoverScene) + "/none.yaml"}, "none.yaml");
  const std::string scenes = TACTUS_SOURCE_DIR "/config/scenes/";
  expectRefusal({scenes + "free_motion.yaml"}, "no tactile module is read");
  expectRefusal({log_.path(), "--set", mass + "0.4"},
                "--set:1:1: -: a log says what its scene was");
}

TEST_F(CoverRunTest, ASceneMayHaveTheOtherNameOfYaml) {
  const test::RunFolder folder;
  const std::string scene = folder.path() + "/scene.yml";
  std::ofstream(scene) << "extends: " << kCoverScene << "\n";
  const std::string mass = "simulation.tactile_module.cover.mass_kg=0.4";
  EXPECT_EQ(identified({scene, "--set", mass}), identified({kCoverScene, "--set", mass}));
}

TEST_F(CoverRunTest, ACentreThatIsHardlyToldIsRefused) {
  const std::string mass = "simulation.tactile_module.cover.mass_kg=0.4";
  const auto withNoiseOf = [&](const char* noise_N) {
    const std::string noise = std::string("simulation.tactile_module.noise_N=") + noise_N;
    return identified({kCoverScene, "--set", mass, "--set", noise});
  };
  EXPECT_NE(withNoiseOf("0.05").find("\nmass      0.4"), std::string::npos) << withNoiseOf("0.05");
  const std::string refused = withNoiseOf("0.5");
  EXPECT_NE(refused.find("cover: the centre's x is 0.2"), std::string::npos) << refused;
  EXPECT_NE(refused.find("a deviation of at most 0.019 m, 0.05 of the module's length"),
            std::string::npos)
      << refused;
}

TEST_F(CoverRunTest, ARunWithACompensatedCoverReplaysToTheBit) {
  for (const char* behind_gears : {"false", "true"}) {
    logRun("scenario3_tactus", {{"robot.tactile_module.cover.mass_kg", "0.4"},
                                {"robot.tactile_module.cover.behind_gears", behind_gears},
                                {"simulation.duration_s", "9"}});
    EXPECT_EQ(test::runCommand(addReplayCommand, {"replay", log_.path()}, output_), kExitDone)
        << output_;
  }
}

TEST(CoverBehindGears, IsCompensatedWhereTheGearsAreKnown) {
  const auto peakOf = [](const char* behind_gears) {
    const Scene scene = test::shippedScene(
        "scenario3_tactus", {{"simulation.arm", "flexible_gears"},
                             {"robot.tactile_module.cover.mass_kg", "0.4"},
                             {"robot.tactile_module.cover.behind_gears", behind_gears}});
    double peak_N = 0.0;
    simulate(scene, [&](const CycleRecord& record) {
      peak_N = std::max(peak_N, record.force_sensor_N[0]);
    });
    return peak_N;
  };
  EXPECT_LT(peakOf("true"), 5.3) << "5.04 without a cover";
  EXPECT_GT(peakOf("false"), 10.0) << "the gears make no difference: this test is blind";
}

TEST_F(CoverRunTest, AChannelAtItsRailEndsARunAndItsLogReplays) {
  const std::vector<Override> overrides = {{"robot.tactile_module.counts_per_N", "6e6"}};
  const Scene scene = test::shippedScene("scenario1_none", overrides);
  double last_speed = 1.0;
  std::uint64_t last_fault = 0;
  const FaultReport end = simulate(scene, [&](const CycleRecord& record) {
                            last_speed = std::abs(record.dq[1]);
                            last_fault = record.fault;
                          }).figures.end;
  EXPECT_EQ(end.fault, Fault::kTactileSaturated) << "1.4 N a channel, of more than 5 N";
  EXPECT_EQ(end.detail.module, 0);
  EXPECT_EQ(last_speed, 0.0);
  EXPECT_EQ(last_fault, static_cast<std::uint64_t>(Fault::kTactileSaturated));
  logRun("scenario1_none", overrides);
  EXPECT_EQ(test::runCommand(addReplayCommand, {"replay", log_.path()}, output_), kExitDone)
      << output_;
}

TEST(CoverCheck, WarnsOfACoverThatNobodyCompensates) {
  const auto warningsOf = [](const Override& setting) {
    return checkPath(test::shippedScene("scenario1_tactus", {setting}));
  };
  const auto warnings = warningsOf({"simulation.tactile_module.cover.mass_kg", "0.5"});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("the cover of 0.5 kg on link4 is felt"), 0u) << warnings[0];
  EXPECT_NE(warnings[0].find("9.81 N"), std::string::npos) << "twice its weight";
  EXPECT_TRUE(warningsOf({"robot.tactile_module.cover.mass_kg", "0.5"}).empty());
  EXPECT_TRUE(warningsOf({"simulation.tactile_module.cover.mass_kg", "0"}).empty());
}

TEST(CoverLoad, ASceneTakesTheRobotsCoverUnlessItHasItsOwn) {
  const auto sceneWith = [](const std::vector<Override>& settings) {
    return test::shippedScene("scenario1_tactus", settings);
  };
  const Scene none = sceneWith({});
  EXPECT_FALSE(none.plant.modules[0].cover || none.controller.tactile_modules[0].cover);
  const Scene both = sceneWith({{"robot.tactile_module.cover.mass_kg", "0.4"}});
  EXPECT_EQ(both.plant.modules[0].cover->mass_kg, 0.4);
  EXPECT_EQ(both.controller.tactile_modules[0].cover->p_ModuleCenter, Vector3(0.19, 0.0, 0.0));
  EXPECT_EQ(both.controller.gravity_Base, Vector3(0.0, 0.0, -9.81));
  EXPECT_FALSE(both.controller.geared_links);
  const Scene other = sceneWith({{"robot.tactile_module.cover.mass_kg", "0.4"},
                                 {"robot.gravity_m_per_s2", "[9.81, 0, 0]"},
                                 {"simulation.tactile_module.cover", "{mass_kg: 0.36}"}});
  EXPECT_EQ(other.plant.modules[0].cover->mass_kg, 0.36);
  EXPECT_EQ(other.controller.tactile_modules[0].cover->mass_kg, 0.4);
  EXPECT_EQ(other.plant.gravity_Base, Vector3(9.81, 0.0, 0.0));
}

TEST(CoverLoad, GearsThatNobodyDescribesAreRefused) {
  try {
    loadScene(TACTUS_SOURCE_DIR "/config/scenes/robots/kuka_iiwa7_contact.yaml",
              {{"robot.tactile_module.cover.mass_kg", "0.4"},
               {"robot.tactile_module.cover.behind_gears", "true"}});
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cover.behind_gears: the robot has no gear_stiffness"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace tactus
