#include "tactus/run/arm_check.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "support/scene_files.h"
#include "support/shipped_scene.h"
#include "tactus/run/scene_check.h"

namespace tactus {
namespace {

using test::SceneFiles;
using Warnings = std::vector<std::string>;

bool has(const Warnings& warnings, const std::string& part) {
  return std::ranges::any_of(warnings, [&](const std::string& warning) {
    return warning.find(part) != std::string::npos;
  });
}

/// All lengths of the URDF times a factor, written as numbers.
std::string scaledUrdf(const std::string& urdf, double factor) {
  std::string scaled;
  const std::regex lengths(R"(<origin xyz="(\S+) (\S+) (\S+)\")");
  auto rest = urdf.cbegin();
  for (std::sregex_iterator it(urdf.begin(), urdf.end(), lengths), end; it != end; ++it) {
    scaled.append(rest, urdf.cbegin() + it->position());
    scaled += "<origin xyz=\"";
    for (int i = 1; i <= 3; ++i)
      scaled += std::to_string(factor * std::stod((*it)[i])) + (i < 3 ? " " : "\"");
    rest = urdf.cbegin() + it->position() + it->length();
  }
  return scaled.append(rest, urdf.cend());
}

/// The masses of crops9 are assumed, its accelerations are meant never to matter: what it says of
/// those is true.
TEST(ArmCheck, HasNothingButEffortsAgainstTheArmsThatComeAlong) {
  int scenes = 0;
  const std::filesystem::path folder = TACTUS_SOURCE_DIR "/config/scenes";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    for (const std::string& warning : checkArm(loadScene(entry.path().string(), {})))
      EXPECT_NE(warning.find("limits.acceleration asks for more than"), std::string::npos)
          << entry.path() << ": " << warning;
    ++scenes;
  }
  EXPECT_GT(scenes, 20);
}

Warnings ofCovers(const std::vector<Override>& overrides) {
  Warnings warnings = checkArm(test::shippedScene("whole_arm/crops9_skin_two_links", overrides));
  std::erase_if(warnings, [](const std::string& warning) {
    return warning.find("taken out of the readings") == std::string::npos;
  });
  return warnings;
}

/// Each of these presses with 14 to 40 N where 5 N are the limit.
TEST(ArmCheck, WarnsOfCoversThatAreSimulatedOtherwiseThanTheyAreTakenOut) {
  const std::string cutoff = "simulation.tactile_module.filter_cutoff_hz";
  const std::string cover = "simulation.tactile_module.cover";
  for (const std::string filter : {"6", "10", "23", "37"}) {
    const Warnings warnings = ofCovers({{cutoff, filter}});
    EXPECT_EQ(warnings.size(), 3u) << filter;
    EXPECT_TRUE(has(warnings, "link4 is simulated with 0.3 kg and a filter of " + filter + " Hz"));
  }
  EXPECT_TRUE(has(ofCovers({{cover, "{mass_kg: 0.15}"}}), "link4 is simulated with 0.15 kg"));
  EXPECT_TRUE(has(ofCovers({{"simulation.arm", "flexible_gears"}}), "link3, link4, link6"));
  EXPECT_EQ(ofCovers({{cutoff, "16"}}), Warnings{});
  EXPECT_EQ(ofCovers({{cover, "{mass_kg: 0.2}"}}), Warnings{});
  EXPECT_EQ(ofCovers({{"simulation.arm", "rigid_gears"}}), Warnings{});
}

TEST(ArmCheck, WarnsOfVeryUnequalWeights) {
  const auto warningsOf = [](const std::string& most) {
    return checkArm(test::shippedScene(
        "scenario2_tactus", {{"redundancy.weights", "[" + most + ", 1, 1, 1, 1, 1, 1, 1, 1]"}}));
  };
  EXPECT_TRUE(has(warningsOf("1000"), "the largest is 1e+03 times the smallest"));
  EXPECT_FALSE(has(warningsOf("100"), "times the smallest"));
}

/// One that weighs nothing is taken out of no reading, whatever filters it.
TEST(ArmCheck, KnowsThatAFilterAloneDoesNoHarm) {
  const Warnings warnings = checkArm(test::shippedScene(
      "scenario3_tactus", {{"simulation.arm", "flexible_gears"},
                           {"simulation.tactile_module.filter_cutoff_hz", "37"}}));
  EXPECT_FALSE(has(warnings, "taken out of the readings"));
}

/// A URDF's names are somebody else's, and go to a terminal.
TEST(ArmCheck, NamesOfAUrdfReachNoTerminalAsCommands) {
  SceneFiles files;
  files.urdf =
      std::regex_replace(files.urdf, std::regex("<robot name=\""), "<robot name=\"&#27;[31m&#10;");
  files.urdf = std::regex_replace(files.urdf, std::regex("joint name=\"lift\""),
                                  "joint name=\"li&#27;[2Jft\"");
  const Scene scene = files.load();
  ASSERT_NE(scene.robot_name.find('\x1b'), std::string::npos);
  const std::string text = checkText(scene, examine(scene));
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
  EXPECT_NE(text.find("\\x1b[31m\\x0a"), std::string::npos) << text;
  EXPECT_NE(text.find("li\\x1b[2Jft"), std::string::npos) << text;
}

TEST(ArmCheck, TellsBothEndsOfEachCover) {
  const std::vector<CoverReport> covers = coversAtStart(SceneFiles{}.load());
  ASSERT_EQ(covers.size(), 1u);
  EXPECT_EQ(covers[0].link, "cover");
  // lift 0.1 up, spacer 0.1 and shoulder 0.2 along x, turned by 0.2, the cover 0.05 from there
  const Vector3 along(std::cos(0.2), std::sin(0.2), 0.0);
  const Vector3 shoulder(0.3, 0.0, 0.1);
  EXPECT_LT((covers[0].ends.p_BaseStart - shoulder - 0.05 * along).norm(), 1e-12);
  EXPECT_LT((covers[0].ends.p_BaseEnd - shoulder - 0.45 * along).norm(), 1e-12);
  EXPECT_TRUE(coversAtStart(test::shippedScene("free_motion")).empty());
}

TEST(ArmCheck, WarnsOfACoverAcrossItsLink) {
  SceneFiles files;
  EXPECT_EQ(checkArm(files.load()), Warnings{});
  files.urdf = test::replaced(files.urdf, R"(<origin xyz="0.05 0 0"/>)",
                              R"(<origin xyz="0.05 0 0" rpy="0 0 1.5707963"/>)");
  const Warnings warnings = checkArm(files.load());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(has(warnings, "the x axis of cover leads 400 mm away")) << warnings[0];
}

TEST(ArmCheck, WarnsOfSizesThatNoRobotHas) {
  SceneFiles files;
  const std::string urdf = files.urdf;
  for (const double usual : {0.2, 1.0, 5.0}) {
    files.urdf = scaledUrdf(urdf, usual);
    EXPECT_FALSE(has(checkArm(files.load()), "which no robot's is")) << usual;
  }
  files.urdf = scaledUrdf(urdf, 1000.0);
  EXPECT_TRUE(has(checkArm(files.load()),
                  "the link behind joint shoulder is 500 m long, which no robot's is"));
  files.urdf = scaledUrdf(urdf, 0.001);
  EXPECT_TRUE(has(checkArm(files.load()), "the whole arm is 1.12 mm long"));
}

/// Also of one end alone; a joint that slides has its limits in m, one without an end has none.
TEST(ArmCheck, WarnsOfLimitsThatLookLikeDegrees) {
  const auto warningsWith = [](const std::string& shoulder, const std::string& lift) {
    SceneFiles files;
    files.urdf = test::replaced(files.urdf, R"(lower="-2" upper="2")", shoulder);
    files.urdf = test::replaced(files.urdf, R"(lower="-1" upper="0.5")", lift);
    return checkArm(files.load());
  };
  const std::string metres = R"(lower="-1" upper="0.5")";
  const Warnings warnings = warningsWith(R"(lower="-170" upper="170")", metres);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(has(warnings, "are they in degrees?")) << warnings[0];
  EXPECT_TRUE(has(warnings, ": shoulder from -170 to 170")) << warnings[0];
  EXPECT_TRUE(has(warningsWith(R"(lower="-170" upper="3")", metres), "from -170 to 3"));
  EXPECT_TRUE(has(warningsWith(R"(lower="-3" upper="170")", metres), "from -3 to 170"));
  EXPECT_EQ(warningsWith(R"(lower="-12.57" upper="25")", metres), Warnings{});
  EXPECT_EQ(warningsWith(R"(lower="-2" upper="2")", R"(lower="-30" upper="30")"), Warnings{});
}

/// M is known by hand for the carriage j1: all that the arm weighs, and its rotor.
TEST(ArmCheck, WarnsOfAccelerationsWithoutTorque) {
  const Scene scene = test::shippedScene("scenario1_null_space");
  double mass_kg = scene.arm->dynamics.rotor_inertia[0];
  for (const BodyInertia& body : scene.arm->dynamics.bodies) mass_kg += body.mass_kg;
  const auto warningsAt = [](double acceleration) {
    return checkArm(test::shippedScene(
        "scenario1_null_space", {{"robot.limits.acceleration[0]", std::to_string(acceleration)},
                                 {"robot.limits.acceleration[1]", "1"},
                                 {"robot.limits.acceleration[2]", "1"},
                                 {"robot.limits.acceleration[3]", "1"},
                                 {"robot.limits.acceleration[4]", "1"},
                                 {"robot.limits.acceleration[5]", "1"},
                                 {"robot.limits.acceleration[6]", "1"},
                                 {"robot.limits.acceleration[7]", "1"},
                                 {"robot.limits.acceleration[8]", "1"}}));
  };
  const double most = scene.arm->max_effort[0] / mass_kg;
  EXPECT_EQ(warningsAt(0.999 * most), Warnings{});
  EXPECT_TRUE(has(warningsAt(1.001 * most), "effort: j1 needs 1e+03 of 1000 N (at most "));
}

TEST(ArmCheck, TakesAnEffortOfZeroForNone) {
  SceneFiles files;
  files.urdf = test::replaced(files.urdf, R"(velocity="0.7")", R"(effort="0" velocity="0.7")");
  files.urdf = test::replaced(files.urdf, R"(velocity="1.5")", R"(effort="7" velocity="1.5")");
  files.urdf = test::replaced(
      files.urdf, R"(<link name="link2"/>)",
      R"(<link name="link2"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>)");
  files.robot += "dynamics: {rotor_inertia: [1, 1, 1]}\n";
  const Scene scene = files.load();
  ASSERT_TRUE(scene.arm);
  EXPECT_EQ(scene.arm->max_effort, Vector3(kNoLimit, 7.0, kNoLimit));
  const Warnings warnings = checkArm(scene);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(has(warnings, "effort: shoulder needs "));
}

TEST(ArmCheck, WarnsOfDrivesThatGiveWayForGood) {
  const std::string name = "scenario1_null_space";
  const std::string part = "drives without an integral part";
  const Override none{"robot.dynamics.servo_integral_hz", "0"};
  EXPECT_TRUE(has(checkArm(test::shippedScene(name, {none})),
                  "leaves its path: j1 j2 j3 j4 j5 j6 j7 j8 j9"));
  std::vector<Override> tracking{none};
  for (int i = 0; i < 9; ++i)
    tracking.push_back({"robot.drives.joints[" + std::to_string(i) + "].tracking_gain_per_s", "5"});
  EXPECT_FALSE(has(checkArm(test::shippedScene(name, tracking)), part));
  tracking.pop_back();
  EXPECT_TRUE(has(checkArm(test::shippedScene(name, tracking)), "leaves its path: j9"));
  EXPECT_FALSE(has(checkArm(test::shippedScene(name)), part));
}

TEST(ArmCheck, TellsOfAPostureThatIsNotReached) {
  Scene scene = test::shippedScene("commands");
  const std::string what = "redundancy.posture is not reached";
  EXPECT_FALSE(has(checkArm(scene), what)) << "there is none";
  scene = test::shippedScene("home");
  EXPECT_FALSE(has(checkArm(scene), what)) << "the shipped one is";
  scene = test::shippedScene("commands", {{"redundancy.posture", "{}"}});
  scene.controller.q_posture =
      0.5 * (scene.controller.limits.lower + scene.controller.limits.upper);
  EXPECT_FALSE(has(checkArm(scene), what)) << "in the middle";
  (*scene.controller.q_posture)[4] = 0.99 * scene.controller.limits.upper[4];
  EXPECT_TRUE(has(checkArm(scene), "further inside their limits: " + scene.joint_names[4]));
  (*scene.controller.q_posture)[4] =
      scene.controller.limits.upper[4] -
      0.0575 * (scene.controller.limits.upper[4] - scene.controller.limits.lower[4]);
  EXPECT_TRUE(has(checkArm(scene), "below 0.11 it does not: " + scene.joint_names[4]));
  scene.controller.gains.joint_limit_avoidance.gain = 0.0;
  EXPECT_FALSE(has(checkArm(scene), what));
  EXPECT_TRUE(has(checkArm(scene), "may press joints against their limits"));
}

}  // namespace
}  // namespace tactus
