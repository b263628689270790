#include <gtest/gtest.h>

#include <string>

#include "support/hardware_files.h"
#include "tactus/canopen/bus_load.h"

/// A robot with several tactile modules: what is read of them, and what is refused.
namespace tactus {
namespace {

using test::BrokenText;
using test::loadError;
using test::moduleEntry;
using test::SceneFiles;
using test::withModules;

/// Modules on cover and link3, with a controller that only reads them.
SceneFiles filesOf(const std::string& entries) {
  SceneFiles files;
  files.scene = test::replaced(files.scene, "variant: null_task", "variant: none");
  files.robot = withModules(files.robot, entries);
  return files;
}

SceneFiles twoModules() {
  return filesOf(moduleEntry("cover") + moduleEntry("link3", "  max_force_N: 50\n"));
}

SceneFiles twoModulesOnBuses(const std::string& first, const std::string& second) {
  SceneFiles files = test::hardwareFiles();
  files.scene = test::replaced(files.scene, "variant: null_task", "variant: none");
  files.robot =
      withModules(files.robot, moduleEntry("cover", first) + moduleEntry("link3", second));
  return files;
}

TEST(TactileModules, AreReadInTheirOrder) {
  const Scene scene = twoModules().load();
  ASSERT_EQ(scene.controller.tactile_modules.size(), 2u);
  EXPECT_EQ(scene.controller.tactile_modules[0].link.joint, 1);
  EXPECT_EQ(scene.controller.tactile_modules[1].link.joint, 2);
  EXPECT_EQ(scene.controller.tactile_modules[0].max_force_N, 100.0);
  EXPECT_EQ(scene.controller.tactile_modules[1].max_force_N, 50.0);
  EXPECT_EQ(scene.module_links, (std::vector<std::string>{"cover", "link3"}));
  ASSERT_EQ(scene.plant.modules.size(), 2u);
  EXPECT_NE(scene.plant.modules[0].seed, scene.plant.modules[1].seed) << "noise of its own";
}

TEST(TactileModules, AListOfOneIsTheOnlyModule) {
  const Scene one = SceneFiles{}.load();
  SceneFiles files;
  files.robot = withModules(files.robot, moduleEntry("cover"));
  const Scene listed = files.load();
  ASSERT_EQ(listed.controller.tactile_modules.size(), 1u);
  EXPECT_EQ(listed.plant.modules[0].channels.calibration,
            one.plant.modules[0].channels.calibration);
  EXPECT_EQ(listed.plant.modules[0].seed, one.plant.modules[0].seed);
  EXPECT_EQ(listed.controller.tactile_modules[0].link.X_JointFrame.p_AB,
            one.controller.tactile_modules[0].link.X_JointFrame.p_AB);
}

TEST(TactileModules, AreSetByEitherSpelling) {
  for (const char* key :
       {"robot.tactile_module.counts_per_N", "robot.tactile_modules[0].counts_per_N"}) {
    const std::vector<Override> setting = {{key, "1e6"}};
    EXPECT_EQ(SceneFiles{}.load(setting).plant.modules[0].channels.counts_per_N, 1e6) << key;
    const Scene scene = twoModules().load(setting);
    EXPECT_EQ(scene.plant.modules[0].channels.counts_per_N, 1e6) << key;
    EXPECT_EQ(scene.plant.modules[1].channels.counts_per_N, 1e5) << key;
  }
  const Scene second = twoModules().load({{"robot.tactile_modules[1].counts_per_N", "2e5"}});
  EXPECT_EQ(second.plant.modules[1].channels.counts_per_N, 2e5);
}

TEST(TactileModules, AreReplacedAsAWhole) {
  const std::string modules =
      "[{link: link3, length_m: 0.1, cover_radius_m: 0.04, calibration: "
      "[[1, 0, 0, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0, 0, 0], "
      "[0, 0, 1, 0, 0, 0, 0, 0], [0, 0, 0, 1, 0, 0, 0, 0]]}]";
  const Override list{"robot.tactile_modules", modules};
  EXPECT_EQ(SceneFiles{}.load({list}).module_links, std::vector<std::string>{"link3"});
  EXPECT_EQ(twoModules().load({list}).module_links, std::vector<std::string>{"link3"});
  for (const SceneFiles& files : {SceneFiles{}, twoModules()}) {
    const Scene scene = files.load({{"robot.tactile_module", "~"}, {"controller", "~"}});
    EXPECT_TRUE(scene.controller.tactile_modules.empty());
    EXPECT_TRUE(scene.plant.modules.empty());
  }
  test::expectError(loadError(SceneFiles{}.sources(), {{"robot.tactile_modules[1].link", "link3"}}),
                    {"", "no second one", "robot.yaml:8:3: tactile_modules[1]: ",
                     "the robot has one module", "tactile_modules[0]"});
}

TEST(TactileModules, HaveFilterPeriodsThatFitEachOther) {
  const auto filesWith = [](const std::string& first_hz, const std::string& second_hz) {
    return filesOf(moduleEntry("cover", "  filter_rate_hz: " + first_hz + "\n") +
                   moduleEntry("link3", "  filter_rate_hz: " + second_hz + "\n"));
  };
  EXPECT_EQ(loadError(filesWith("1000", "2000").sources()), "");
  test::expectError(loadError(filesWith("2000", "3000").sources()),
                    {"", "2000 and 3000", "robot.yaml:17:21: tactile_modules[0].filter_rate_hz: ",
                     "2000 Hz does not fit the other modules", "3000 Hz over a whole number"});
}

TEST(TactileModules, OfEachBusCount) {
  const Scene scene = twoModulesOnBuses("  interface: can1\n  first_id: 0x110\n",
                                        "  interface: can0\n  first_id: 0x110\n")
                          .load();
  const HardwareConfig& hardware = scene.hardware.value();
  ASSERT_EQ(hardware.tactile_modules.size(), 2u);
  for (int module = 0; module < 2; ++module) {
    const int bus = 1 - module;
    EXPECT_EQ(hardware.tactile_modules[module].bus, bus);
    EXPECT_EQ(busLoads(hardware, 0.001)[bus].terms.back().name, std::string("tactile module"));
  }
}

std::string errorOf(const SceneFiles& files) { return loadError(files.sources()); }

TEST(TactileModules, OfOneBusCountTogether) {
  const Scene scene = twoModulesOnBuses("  interface: can1\n  first_id: 0x110\n",
                                        "  interface: can1\n  first_id: 0x114\n")
                          .load();
  const std::vector<BusLoadTerm> terms = busLoads(scene.hardware.value(), 0.001)[1].terms;
  EXPECT_EQ(std::ranges::count(terms, std::string("tactile module"), &BusLoadTerm::name), 2);
}

TEST(TactileModules, ThatDoNotFitAreRefused) {
  const std::string one = moduleEntry("cover");
  test::expectError(errorOf(filesOf(one + moduleEntry("cover"))),
                    {"", "two on a link", "robot.yaml:17:11: tactile_modules[1].link: ",
                     "'cover' has a module already", "a link of its own"});
  test::expectError(errorOf(filesOf(one + moduleEntry("nowhere"))),
                    {"", "unknown link", "robot.yaml:17:11: tactile_modules[1].link: ",
                     "'nowhere' is no link", "the name of a link"});
  std::string nine;
  for (int i = 0; i < 9; ++i) nine += one;
  test::expectError(errorOf(filesOf(nine)), {"", "nine", "robot.yaml:8:3: tactile_modules: ",
                                             "a list of 9", "a list of 1 to 8 sections"});
  SceneFiles both = twoModules();
  both.robot += "tactile_module:\n" + test::kModuleText;
  test::expectError(errorOf(both), {"", "both", "robot.yaml:28:3: tactile_module: ",
                                    "there are tactile_modules, too", "one of the two"});
  SceneFiles law = twoModules();
  law.scene = test::kSceneText;
  test::expectError(errorOf(law),
                    {"", "a law", "scene.yaml:11:12: controller.variant: ",
                     "null_task answers the contact of one tactile module, the robot has 2",
                     "null_limit, none, or a robot with one"});
}

TEST(TactileModules, MayBeLostOnlyOfSeveral) {
  EXPECT_FALSE(twoModules().load().controller.module_loss) << "unless it is asked for";
  EXPECT_FALSE(twoModules().load({{"robot.module_lost", "stop"}}).controller.module_loss);
  const Scene slow = twoModules().load(
      {{"robot.module_lost", "go_on_slowly"}, {"robot.module_lost_speed_share", "0.5"}});
  ASSERT_TRUE(slow.controller.module_loss);
  EXPECT_EQ(slow.controller.module_loss->speed_share, 0.5);
  SceneFiles one = filesOf(moduleEntry("cover"));
  one.robot += "module_lost: go_on_slowly\n";
  test::expectError(errorOf(one), {"", "only one", "robot.yaml:17:14: module_lost: ",
                                   "the robot has 1 tactile module",
                                   "stop, or tactile_modules with two or more"});
  SceneFiles word = twoModules();
  word.robot += "module_lost: go_on\n";
  test::expectError(errorOf(word),
                    {"", "a word", "robot.yaml:27:14: module_lost: ", "go_on", "stop"});
  SceneFiles share = twoModules();
  share.robot += "module_lost_speed_share: 0.5\n";
  test::expectError(errorOf(share),
                    {"", "alone it was ignored", "robot.yaml:27:26: module_lost_speed_share: ",
                     "there is no module_lost", "module_lost: go_on_slowly beside it"});
  share.robot += "module_lost: stop\n";
  EXPECT_FALSE(share.load().controller.module_loss) << "for a while, say";
}

/// Of modules, which are several.
TEST(TactileModules, UnderTheKeyOfTheOnlyOneAreReferredToTheList) {
  SceneFiles files = twoModules();
  files.robot = test::replaced(files.robot, "tactile_modules:", "tactile_module:");
  test::expectError(errorOf(files), {"", "", "robot.yaml:8:3: tactile_module: ", "a list of 2",
                                     "a section of keys; perhaps tactile_modules is meant"});
}

/// {} is a module without a link, and a section with defaults of its own.
TEST(TactileModules, TellWhatASectionWithoutKeysMeans) {
  const auto says = [](const std::string& key, const std::string& value) {
    return test::loadError(SceneFiles{}.sources(), {{key, value}});
  };
  EXPECT_TRUE(says("robot.tactile_module", "5").ends_with("expected a section of keys"));
  EXPECT_TRUE(says("redundancy.joint_limit_avoidance", "5")
                  .ends_with("expected a section of keys ({} for its defaults, null for none)"));
  EXPECT_TRUE(
      says("simulation.tactile_module", "5").ends_with("expected a section of keys ({} for none)"))
      << says("simulation.tactile_module", "5");
}

TEST(TactileModules, WithOneIdOnABusAreRefused) {
  const std::string on = "  interface: can1\n  first_id: ";
  test::expectError(
      errorOf(twoModulesOnBuses(on + "0x110\n", on + "0x113\n")),
      {"", "one id", "robot.yaml:39:15: tactile_modules[1].first_id: ",
       "frame 0x113 is the frame 3 of tactile_modules[0] on the same bus", "four ids of its own"});
  EXPECT_EQ(errorOf(twoModulesOnBuses(on + "0x110\n", on + "0x114\n")), "");
}

}  // namespace
}  // namespace tactus
