#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "support/command_run.h"
#include "support/run_folder.h"
#include "tactus/cli/commands.h"

/// A run of an arm with two tactile modules: log, summary, export and replay.
namespace tactus {
namespace {

const std::string kScene = TACTUS_SOURCE_DIR "/config/scenes/scenario1_none.yaml";

std::string moduleOn(const std::string& link, const std::string& first_id) {
  return "{interface: can3, first_id: " + first_id + ", link: " + link +
         ", length_m: 0.38, cover_radius_m: 0.06, calibration: [[1, -1, 0, 0, 1, -1, 0, 0], "
         "[0, 0, 1, -1, 0, 0, 1, -1], [0, 0, -0.04, 0.04, 0, 0, -0.34, 0.34], "
         "[0.04, -0.04, 0, 0, 0.34, -0.34, 0, 0]]}";
}

TEST(SeveralModulesRun, IsLoggedExportedAndReplayed) {
  const test::RunFolder folder;
  std::string output;
  const std::string modules = moduleOn("link6", "0x110") + ", " + moduleOn("link4", "0x100");
  ASSERT_EQ(
      test::runCommand(
          addSimulateCommand,
          {"simulate", kScene, "-o", folder.path(), "--set", "robot.tactile_module=~", "--set",
           "robot.tactile_modules=[" + modules + "]", "--set", "simulation.duration_s=6"},
          output),
      kExitDone)
      << output;
  const auto summary = nlohmann::json::parse(folder.content("scenario1_none/summary.json"));
  ASSERT_EQ(summary["contacts"].size(), 1u);
  EXPECT_EQ(summary["contacts"][0]["tactile_module"], "link4");
  EXPECT_EQ(summary["contacts"][0]["peak_force_N"], summary["peak_force_N"]);
  EXPECT_GT(summary["peak_force_N"], 1.0);

  const std::string log = folder.path() + "/scenario1_none/run.ulg";
  EXPECT_EQ(test::runCommand(addReplayCommand, {"replay", log}, output), kExitDone) << output;
  const std::string csv = folder.path() + "/run.csv";
  ASSERT_EQ(test::runCommand(addExportCommand, {"export", log, "-o", csv}, output), kExitDone);
  const std::string text = folder.content("run.csv");
  const std::string header = text.substr(0, text.find('\n'));
  EXPECT_NE(header.find("tactile_sequence_2"), std::string::npos);
  EXPECT_EQ(header.find("tactile_sequence_3"), std::string::npos);
}

}  // namespace
}  // namespace tactus
