#include <gtest/gtest.h>

#include "support/scene_files.h"
#include "support/shipped_scene.h"
#include "tactus/scene/clearance_loader.h"

namespace tactus {
namespace {

const std::string kBodies =
    "collision_capsules:\n"
    "  - {link: base, from_m: [0, 0, 0], to_m: [0, 0, 0], radius_m: 0.1}\n"
    "  - {link: link1, from_m: [0, 0, 0], to_m: [0.3, 0, 0], radius_m: 0.05}\n"
    "  - {link: tool, from_m: [0, 0, 0], to_m: [0, 0, 0], radius_m: 0.04}\n";

test::SceneFiles clearFiles(const std::string& section) {
  test::SceneFiles files;
  files.robot += kBodies;
  files.scene += "clearance:\n" + section;
  return files;
}

/// Of each pair and wall pair, in their order.
std::vector<std::string> keptPairs(const Scene& scene) {
  const ClearanceConfig& config = *scene.controller.clearance;
  std::vector<std::string> pairs;
  for (std::size_t i = 0; i < config.pairs.size() + config.wall_pairs.size(); ++i)
    pairs.push_back(namesOfPair(config, scene.clearance, static_cast<int>(i)));
  return pairs;
}

using Names = std::vector<std::string>;

TEST(ClearanceLoad, KeepsLinksApartThatAreNoNeighbours) {
  const Scene scene = clearFiles("  safe_distance_m: 0.03\n").load();
  EXPECT_EQ(keptPairs(scene), (Names{"base and tool", "base and cover", "link1 and tool"}));
  const ClearanceConfig& config = *scene.controller.clearance;
  EXPECT_EQ(config.safe_distance_m, 0.03);
  EXPECT_EQ(config.influence_distance_m, 0.1);
  EXPECT_FALSE(config.avoid);
  EXPECT_EQ(config.capsules.back().radius_m, 0.05) << "the cover";
  const std::vector<std::string> stages = stageNames(scene.controller);
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "clearance"), 1);
  EXPECT_FALSE(test::SceneFiles().load().controller.clearance);
}

TEST(ClearanceLoad, LeavesOutWhatIsExcluded) {
  EXPECT_EQ(keptPairs(clearFiles("  exclude: [{link: tool, other: base}]\n").load()),
            (Names{"base and cover", "link1 and tool"}));
}

/// The lift changes only heights, so link1 comes no nearer to an upright wall.
TEST(ClearanceLoad, KnowsWallsAndBodies) {
  const Scene scene =
      clearFiles(
          "  self_collision: false\n"
          "  avoid: {distance_m: 0.3, gain_per_s: 3}\n"
          "  keep_out:\n"
          "    - plane: {point_m: [2, 0, 0], normal: [-2, 0, 0]}\n"
          "    - {sphere: {center_m: [0, 2, 0], radius_m: 0.2}, for: tool}\n"
          "    - post: {foot_m: [0, -2, 0], axis: [0, 0, 3], height_m: 2, radius_m: 0.1}\n")
          .load();
  EXPECT_EQ(keptPairs(scene),
            (Names{"tool and keep_out[1]", "link1 and keep_out[2]", "tool and keep_out[2]",
                   "cover and keep_out[2]", "tool and keep_out[0]", "cover and keep_out[0]"}));
  const ClearanceConfig& config = *scene.controller.clearance;
  EXPECT_EQ(config.walls[0].normal, Vector3(-1, 0, 0));
  EXPECT_EQ(config.avoid->gain_per_s, 3.0);
  const LinkCapsule& post = config.capsules.back();
  EXPECT_EQ(post.link.joint, -1);
  EXPECT_EQ(post.p_LinkTo, Vector3(0, -2, 2));
}

TEST(ClearanceLoad, LeavesOutWhatAlwaysTouches) {
  test::SceneFiles files = clearFiles("  self_collision: true\n");
  files.robot =
      test::replaced(files.robot, "to_m: [0, 0, 0], radius_m: 0.1", "to_m: [0, 0, 0], radius_m: 3");
  const Scene scene = files.load();
  EXPECT_EQ(keptPairs(scene), (Names{"link1 and tool"}));
  ASSERT_EQ(scene.clearance.touching.size(), 2u);
  EXPECT_EQ(scene.clearance.capsules[scene.clearance.touching[1].other], "cover");
}

/// What touches at the start and no further than a metre away is not what always touches.
TEST(ClearanceLoad, LooksAlongAWholeRail) {
  test::SceneFiles files = clearFiles("  self_collision: true\n");
  files.robot =
      test::replaced(files.robot, "to_m: [0, 0, 0], radius_m: 0.1", "to_m: [0, 0, 0], radius_m: 3");
  files.urdf = test::replaced(files.urdf, "upper=\"0.5\"", "upper=\"8\"");
  const std::string error = test::loadError(files.sources());
  EXPECT_NE(error.find(" overlap by "), std::string::npos) << error;
  EXPECT_EQ(keptPairs(files.load({{"start[0]", "7"}})),
            (Names{"base and tool", "base and cover", "link1 and tool"}));
}

TEST(ClearanceLoad, RefusesToAvoidWhereTheTaskTakesAllJoints) {
  const test::SceneFiles files = clearFiles("  avoid: {distance_m: 0.3, gain_per_s: 2}\n");
  EXPECT_EQ(test::loadError(files.sources()), "");
  const std::string error = test::loadError(files.sources(), {{"task.components", "[x, y, z]"}});
  EXPECT_NE(error.find("clearance.avoid: the task takes all joints"), std::string::npos) << error;
}

/// The lift's lever is 1, as 11.1/s of the gain with 0.3 m; what is said to do does.
TEST(ClearanceLoad, RefusesToAvoidFasterThanACycleCanFollow) {
  const auto errorWith = [](double gain_per_s) {
    return test::loadError(
        clearFiles("  avoid: {distance_m: 0.3, gain_per_s: " + std::to_string(gain_per_s) + "}\n")
            .sources());
  };
  EXPECT_EQ(errorWith(2.0), "");
  const std::string error = errorWith(900.0);
  const std::size_t at = error.find("expected at most ");
  ASSERT_NE(at, std::string::npos) << error;
  EXPECT_NE(error.find("clearance.avoid.gain_per_s: 900 is too steep"), std::string::npos) << error;
  const double most_per_s = std::stod(error.substr(at + 17));
  EXPECT_GT(most_per_s, 10.0);
  EXPECT_LT(most_per_s, 400.0);
  EXPECT_EQ(errorWith(most_per_s), "");
  EXPECT_NE(errorWith(1.01 * most_per_s), "");
}

/// What each of several bodies asks for adds up: of two walls in one place half of the gain.
TEST(ClearanceLoad, BoundsTheGainOfAllBodiesTogether) {
  const auto bound_per_s = [](int walls) {
    std::string section =
        "  self_collision: false\n  avoid: {distance_m: 0.5, gain_per_s: 900}\n  keep_out:\n";
    for (int i = 0; i < walls; ++i)
      section += "    - plane: {point_m: [0, 0, -0.3], normal: [0, 0, 1]}\n";
    const std::string error = test::loadError(clearFiles(section).sources());
    const std::size_t at = error.find("expected at most ");
    EXPECT_NE(at, std::string::npos) << error;
    return at == std::string::npos ? 0.0 : std::stod(error.substr(at + 17));
  };
  const double one_per_s = bound_per_s(1);
  EXPECT_GT(one_per_s, 1.0);
  EXPECT_NEAR(bound_per_s(2), one_per_s / 2.0, 1e-2 * one_per_s);
}

TEST(ClearanceLoad, EndsAsOneLine) {
  const auto expectError = [](const std::string& section, const std::string& part) {
    const std::string error = test::loadError(clearFiles(section).sources());
    EXPECT_NE(error.find(part), std::string::npos) << part << " in " << error;
    EXPECT_EQ(error.substr(0, 11), "scene.yaml:") << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  };
  const auto expectBody = [&](const std::string& body, const std::string& part) {
    expectError("  keep_out: [{" + body + "}]\n", "clearance.keep_out[0]" + part);
  };
  expectError("  safe_distance_m: 0.1\n",
              "clearance.influence_distance_m: 0.1 m is not above safe_distance_m, expected more "
              "than 0.1");
  expectError("  avoid: {distance_m: 0.02}\n",
              "scene.yaml:23:23: clearance.avoid.distance_m: 0.02 m is not above safe_distance_m");
  expectError("  safe_distance_m: -1\n", "clearance.safe_distance_m: '-1' is out of range");
  expectError("  keep_out: [{}]\n", "clearance.keep_out[0]: ");
  expectBody("for: all", ": no shape, expected one of plane, sphere, post");
  expectBody(
      "sphere: {center_m: [9, 9, 9], radius_m: 1}, plane: {point_m: [9, 0, 0], normal: [1, 0, 0]}",
      ": more than one shape, expected one of plane, sphere, post");
  expectBody("plane: {point_m: [9, 0, 0], normal: [0, 0, 0]}",
             ".plane.normal: has no length, expected a vector other than zero");
  expectBody("post: {foot_m: [9, 0, 0], axis: [0, 0, 0], height_m: 1}",
             ".post.axis: has no length");
  expectBody("plane: {point_m: [9, 0, 0], normal: [1, 0, 0]}, for: hand", ".for: 'hand'");
  expectError("  exclude: [{link: link1, other: toil}]\n",
              "clearance.exclude[0].other: 'toil' has no collision_capsules, expected perhaps "
              "'tool'");
  expectError("  exclude: [{link: tool, other: tool}]\n",
              "clearance.exclude[0].other: 'tool' with itself, of which no pair is made, expected "
              "another link");
  expectError("  self_collision: false\n", "clearance: there is nothing to keep clear of");
}

TEST(ClearanceLoad, RefusesAStartThatIsNotClear) {
  const auto errorOf = [](const std::string& section) {
    return test::loadError(clearFiles(section).sources());
  };
  const std::string close = errorOf("  safe_distance_m: 0.25\n  influence_distance_m: 1\n");
  EXPECT_NE(close.find("scene.yaml:23:20: clearance.safe_distance_m: base and cover are 0."),
            std::string::npos)
      << close;
  EXPECT_NE(close.find("at the start, expected at least 0.25 m"), std::string::npos) << close;
  const std::string held =
      errorOf("  keep_out: [{plane: {point_m: [0.6, 0, 0], normal: [-1, 0, 0]}}]\n");
  EXPECT_NE(held.find("tool and keep_out[0] overlap by 0."), std::string::npos) << held;
}

TEST(ClearanceLoad, NeedsCapsules) {
  test::SceneFiles files = clearFiles("  self_collision: true\n");
  files.robot = test::kRobotText;
  EXPECT_NE(test::loadError(files.sources()).find("clearance: the robot has no collision_capsules"),
            std::string::npos);
  files =
      clearFiles("  keep_out: [{plane: {point_m: [9, 0, 0], normal: [-1, 0, 0]}, for: tool}]\n");
  files.robot = test::replaced(files.robot, "link: tool,", "link: link1,");
  EXPECT_NE(test::loadError(files.sources())
                .find("clearance.keep_out[0].for: no collision capsule moves with the last joint"),
            std::string::npos);
}

}  // namespace
}  // namespace tactus
