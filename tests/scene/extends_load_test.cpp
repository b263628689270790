#include <gtest/gtest.h>

#include "support/scene_files.h"

namespace tactus {
namespace {

using test::SceneFiles;

/// The scene of the support file as base/base.yaml, with `scenes` before and the robot behind it.
std::vector<SourceFile> withBase(std::vector<SourceFile> scenes) {
  SceneFiles files;
  files.scene = test::replaced(files.scene, "robot: robot.yaml", "robot: ../robots/robot.yaml");
  scenes.push_back({"base/base.yaml", files.scene});
  scenes.push_back({"robots/robot.yaml", files.robot});
  scenes.push_back({"robots/robot.urdf", files.urdf});
  return scenes;
}

Scene loadOver(const std::string& text) {
  return loadScene(withBase({{"run.yaml", "extends: base/base.yaml\n" + text}}), {});
}

TEST(Extends, TakesEverythingThatIsNotNamed) {
  const Scene scene = loadOver("");
  EXPECT_EQ(scene.name, "run");
  EXPECT_EQ(scene.duration_s, 13.0);
  EXPECT_EQ(scene.variant, "null_task");
}

TEST(Extends, MergesSectionsAndReplacesListsAndValues) {
  const Scene scene = loadOver(
      "controller: {damping: 0.9, variant: null_space}\n"
      "simulation: {obstacles: [{x_m: 1, y_m: 2, stiffness_N_per_m: 3}]}\n");
  EXPECT_EQ(scene.variant, "null_space");
  EXPECT_EQ(scene.controller.gains.force.damping, 0.9);
  EXPECT_EQ(scene.controller.gains.force.activation_force_N, 3.8);
  EXPECT_EQ(scene.duration_s, 13.0);
  ASSERT_EQ(scene.plant.obstacles.size(), 1u);
  EXPECT_EQ(scene.plant.obstacles[0].x_m, 1.0);
}

TEST(Extends, NullRemoves) {
  const Scene scene = loadOver("controller: ~\nstart: null\nsimulation: {obstacles: ~}\n");
  EXPECT_TRUE(scene.controller.tactile_modules.empty());
  EXPECT_EQ(scene.controller.q_start, Vector3(0, 0.5, -0.5));
  EXPECT_TRUE(scene.plant.obstacles.empty());
}

TEST(Extends, WhatWasRemovedCanComeBack) {
  const Scene scene =
      loadScene(withBase({{"run.yaml", "extends: middle.yaml\nstiffness: {assumed_N_per_m: 5}\n"},
                          {"middle.yaml", "extends: base/base.yaml\nstiffness: ~\n"}}),
                {});
  EXPECT_EQ(scene.controller.gains.force.assumed_stiffness_N_per_m, 5.0);
  EXPECT_FALSE(scene.controller.force_control->has_estimator) << "removed with its section";
}

TEST(Extends, KeepsAllFilesInTheOrderOfTheirReading) {
  std::vector<std::string> paths;
  for (const SourceFile& file : loadOver("").sources) paths.push_back(file.path);
  EXPECT_EQ(paths, (std::vector<std::string>{"run.yaml", "base/base.yaml", "robots/robot.yaml",
                                             "robots/robot.urdf"}));
}

TEST(Extends, ThePathOfARobotIsMeantFromTheFileThatNamesIt) {
  EXPECT_EQ(loadOver("robot: robots/robot.yaml\n").robot_name, "three");
  EXPECT_EQ(
      test::loadError(withBase({{"run.yaml", "extends: base/base.yaml\nrobot: robot.yaml\n"}})),
      "run.yaml:2:8: robot: robot.yaml: is not among the recorded files, expected the path of a "
      "robot.yaml, readable, at most 1 MiB");
}

TEST(Extends, AnErrorNamesTheFileItIsIn) {
  std::vector<SourceFile> files = withBase({{"run.yaml", "extends: base/base.yaml\n"}});
  files[1].text = test::replaced(files[1].text, "duration_s: 13", "duration_s: -1");
  test::expectError(test::loadError(files),
                    {"", "", "base/base.yaml:18:15: simulation.duration_s: ", "'-1'", "> 0"});
}

TEST(Extends, AnErrorOfAChangedValueNamesTheChange) {
  test::expectError(
      test::loadError(
          withBase({{"run.yaml", "extends: base/base.yaml\nsimulation:\n  duration_s: -1\n"}})),
      {"", "", "run.yaml:3:15: simulation.duration_s: ", "'-1'", "> 0"});
}

TEST(Extends, ARemovedButNeededKeyIsMissingWhereItWasRemoved) {
  test::expectError(test::loadError(withBase(
                        {{"run.yaml", "extends: base/base.yaml\nsimulation: {duration_s: ~}\n"}})),
                    {"", "", "run.yaml:2:26: simulation.duration_s: ", "is missing", "> 0"});
}

TEST(Extends, RemovingAnUnknownKeyIsAnError) {
  test::expectError(
      test::loadError(withBase({{"run.yaml", "extends: base/base.yaml\nstifness: ~\n"}})),
      {"", "", "run.yaml:2:1: stifness: ", "unknown key", "'stiffness'"});
}

TEST(Extends, AKeyThatBelongsInASectionIsNamedWithIt) {
  test::expectError(
      test::loadError(withBase({{"run.yaml", "extends: base/base.yaml\ndamping: 1\n"}})),
      {"", "", "run.yaml:2:1: damping: ", "unknown key", "'controller.damping'"});
}

TEST(Extends, CirclesAreErrors) {
  test::expectError(test::loadError({{"run.yaml", "extends: ./run.yaml\n"}}),
                    {"", "", "run.yaml:1:10: extends: ", "leads back", "no circle"});
  test::expectError(
      test::loadError({{"run.yaml", "extends: a/b.yaml\n"}, {"a/b.yaml", "extends: ../run.yaml"}}),
      {"", "", "a/b.yaml:1:10: extends: ", "leads back", "no circle"});
}

TEST(Extends, LongRowsAreErrors) {
  std::vector<SourceFile> files;
  for (int i = 0; i < 12; ++i) {
    files.push_back({std::to_string(i) + ".yaml", "extends: " + std::to_string(i + 1) + ".yaml"});
  }
  test::expectError(test::loadError(files),
                    {"", "", "8.yaml:1:10: extends: ", "too many files in a row", "at most 8"});
}

TEST(Extends, HasToNameAFile) {
  test::expectError(test::loadError({{"run.yaml", "extends: [a, b]\n"}}),
                    {"", "", "run.yaml:1:10: extends: ", "a list of 2", "the path of a scene"});
  test::expectError(
      test::loadError({{"run.yaml", "extends: gone.yaml\n"}}),
      {"", "", "run.yaml:1:10: extends: ", "gone.yaml: is not among", "a readable file"});
}

}  // namespace
}  // namespace tactus
