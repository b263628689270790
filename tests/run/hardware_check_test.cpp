#include "tactus/run/hardware_check.h"

#include <filesystem>

#include "support/hardware_files.h"
#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/run/scene_check.h"

namespace tactus {
namespace {

using Said = std::vector<std::string>;

int countOf(const Said& warnings, const std::string& part) {
  return static_cast<int>(std::ranges::count_if(warnings, [&](const std::string& warning) {
    return warning.find(part) != std::string::npos;
  }));
}

std::vector<std::string> shippedScenes() {
  std::vector<std::string> paths;
  const std::filesystem::path folder = TACTUS_SOURCE_DIR "/config/scenes";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".yaml") paths.push_back(entry.path().string());
  return paths;
}

const std::string kNoEnable = "no gpio.enable: tactusd moves the arm as soon as it is started";

/// They have no enable line, which is true, and nothing else.
TEST(HardwareCheck, HasNothingButNoEnableLineAgainstTheMachinesThatComeAlong) {
  for (const std::string& path : shippedScenes()) {
    const Scene scene = loadScene(path, {});
    EXPECT_EQ(checkMachine(scene), scene.hardware ? Said{kNoEnable} : Said{}) << path;
  }
}

TEST(HardwareCheck, WarnsOfAnArmThatMovesUnasked) {
  Scene scene = test::hardwareFiles().load();
  ASSERT_TRUE(scene.hardware->gpio) << "other lines";
  EXPECT_EQ(countOf(checkMachine(scene), kNoEnable), 1);
  scene.hardware->gpio->enable.emplace();
  EXPECT_EQ(countOf(checkMachine(scene), "gpio.enable"), 0);
  scene.hardware->gpio.reset();
  EXPECT_EQ(countOf(checkMachine(scene), kNoEnable), 1);
  const Scene refused = test::shippedScene("commands", {{"task.commands.start_measured", "true"}});
  EXPECT_EQ(countOf(checkMachine(refused), kNoEnable), 0) << "it is not started at all";
}

TEST(HardwareCheck, TellsOfAStartThatTheDaemonRefuses) {
  Scene scene = test::shippedScene("commands", {{"task.commands.start_measured", "true"}});
  ASSERT_FALSE(scene.hardware->gpio);
  EXPECT_EQ(countOf(checkMachine(scene), "tactusd refuses task.commands.start_measured"), 1);
  scene.hardware->gpio.emplace();
  EXPECT_EQ(countOf(checkMachine(scene), "gpio.enable"), 1);
  scene.hardware->gpio->enable.emplace();
  EXPECT_EQ(countOf(checkMachine(scene), "start_measured"), 0);
  scene.hardware.reset();
  EXPECT_EQ(countOf(checkMachine(scene), "start_measured"), 0) << "it is simulated alone";
}

TEST(HardwareCheck, WarnsOfStopsThatAreSteps) {
  test::SceneFiles files = test::hardwareFiles();
  EXPECT_EQ(countOf(checkMachine(files.load()), "no limits.acceleration"), 1);
  files.robot += "limits: {acceleration: [10, 20, 30]}\n";
  EXPECT_EQ(countOf(checkMachine(files.load()), "no limits.acceleration"), 0);
}

/// What the check has nothing against starts: boot, tare, motion.
TEST(HardwareCheck, ScenesThatComeAlongStartOnTheBuses) {
  int scenes = 0;
  for (const std::string& path : shippedScenes()) {
    const Scene scene = loadScene(path, {});
    if (!scene.hardware) continue;
    test::VirtualRobotCell cell(scene);
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000))
        << path << ": " << faultName(cell.cycle.report().fault);
    ++scenes;
  }
  EXPECT_GT(scenes, 20);
}

/// The worst case, by the robot's own gravity.
TEST(HardwareCheck, WarnsOfATareThatTheCoverAloneExceeds) {
  const auto warningsWith = [](const std::string& mass_kg, const std::string& max_offset_N) {
    const Said warnings = checkMachine(
        test::hardwareFiles().load({{"robot.gravity_m_per_s2", "[0, 3, -4]"},
                                    {"robot.tactile_module.cover.mass_kg", mass_kg},
                                    {"robot.tactile_module.tare.max_offset_N", max_offset_N}}));
    return countOf(warnings, "the cover of cover weighs 2 N, and its tare.max_offset_N is " +
                                 max_offset_N + " N");
  };
  EXPECT_EQ(warningsWith("0.4", "2"), 1);
  EXPECT_EQ(warningsWith("0.4", "1.5"), 1);
  EXPECT_EQ(warningsWith("0.4", "2.01"), 0);
  EXPECT_EQ(warningsWith("0.3", "1.6"), 0);
  EXPECT_EQ(countOf(checkMachine(test::hardwareFiles().load()), "tare_refused"), 0) << "no cover";
}

/// Each as it is meant, at the end of what may be meant, and in another unit.
TEST(HardwareCheck, WarnsOfLimitsInTheWrongUnit) {
  const std::string joint = "robot.drives.joints";
  const auto saysOf = [](const std::string& key, const std::string& value) {
    for (const std::string& warning : checkMachine(test::hardwareFiles().load({{key, value}}))) {
      const std::size_t at = warning.find("they are in m, rad and s: ");
      if (at != std::string::npos) return warning.substr(at + 26);
    }
    return std::string();
  };
  EXPECT_EQ(saysOf("robot.drives.start_tolerance", "0.2"), "");
  EXPECT_EQ(saysOf("robot.drives.start_tolerance", "2"), "drives.start_tolerance is 2");
  EXPECT_EQ(saysOf(joint + "[1].max_following_error_m", "0.2"), "");
  EXPECT_EQ(saysOf(joint + "[1].max_following_error_m", "0.3"),
            "max_following_error_m of lift is 0.3");
  EXPECT_EQ(saysOf(joint + "[0].max_following_error_rad", "0.5"), "");
  EXPECT_EQ(saysOf(joint + "[0].max_following_error_rad", "3"),
            "max_following_error_rad of roll is 3");
  EXPECT_EQ(saysOf("robot.can.heartbeat_timeout_s", "1"), "");
  EXPECT_EQ(saysOf("robot.can.heartbeat_timeout_s", "60"), "can.heartbeat_timeout_s is 60");
  EXPECT_EQ(saysOf("robot.tactile_module.max_sample_age_s", "0.1"), "");
  EXPECT_EQ(saysOf("robot.tactile_module.max_sample_age_s", "0.2"),
            "max_sample_age_s of cover is 0.2");
  test::SceneFiles slow = test::hardwareFiles();
  slow.robot = test::replaced(slow.robot, "sample_period_s: 0.005",
                              "sample_period_s: 0.02\n  max_sample_age_s: 0.2");
  EXPECT_EQ(countOf(checkMachine(slow.load()), "max_sample_age_s"), 0) << "ten samples";
}

TEST(HardwareCheck, IsAPartOfWhatCheckSays) {
  const Scene scene = test::shippedScene("real/real_scenario1",
                                         {{"robot.tactile_module.tare.max_offset_N", "2.9"}});
  ASSERT_EQ(countOf(checkMachine(scene), "tare_refused"), 1);
  EXPECT_EQ(countOf(examine(scene).warnings, "tare_refused"), 1);
  Scene simulated = scene;
  simulated.hardware.reset();
  EXPECT_EQ(checkMachine(simulated), Said{});
}

}  // namespace
}  // namespace tactus
