#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/command_run.h"
#include "support/random_urdf.h"
#include "support/run_folder.h"
#include "tactus/cli/commands.h"
#include "tactus/math/serial_chain.h"
#include "tactus/record/log_size.h"
#include "tactus/run/arm_check.h"
#include "tactus/run/simulation.h"
#include "tactus/scene/input_error.h"
#include "tactus/scene/json.h"
#include "tactus/scene/path_check.h"
#include "tactus/scene/scene_loader.h"

/// From a URDF to a scene that runs.
namespace tactus {
namespace {

class InitTest : public ::testing::Test {
 protected:
  std::string put(const std::string& name, const std::string& text) const {
    const std::string path = folder_.path() + "/" + name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  Json init(const std::string& urdf, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"init", urdf, "-o", folder_.path() + "/arm", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    std::string output;
    EXPECT_EQ(test::runCommand(addInitCommand, words, output), kExitDone);
    return Json::parse(output);
  }

  std::string refusal(const std::string& urdf, std::vector<std::string> more = {}) {
    try {
      init(urdf, std::move(more));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  Scene written() const { return loadScene(folder_.path() + "/arm/scene.yaml", {}); }
  void clear() const { std::filesystem::remove_all(folder_.path() + "/arm"); }

  test::RunFolder folder_;
};

using Lines = std::vector<std::string>;

/// What `check` would warn of, what a simulation ends by, and what is said of the home pose.
void expectGood(const Scene& scene, const Json& said) {
  EXPECT_EQ(checkPath(scene), Lines{});
  EXPECT_EQ(checkArm(scene), Lines{});
  checkLogSize(scene);
  const ControllerConfig& config = scene.controller;
  const double smallest = smallestSingularValueAtStart(config, config.weights);
  EXPECT_GE(smallest, 0.04) << "0.02 is singular";
  EXPECT_NEAR(said["smallest_singular_value_at_home"].get<double>(), smallest, 1e-6);
  for (int i = 0; i < config.chain.size(); ++i) {
    const double lower = config.limits.lower[i], upper = config.limits.upper[i];
    const double margin = std::min(config.q_start[i] - lower, upper - config.q_start[i]);
    if (upper - lower < kNoLimit) {
      EXPECT_GE(margin, 0.2 * (upper - lower)) << i;
    }
    EXPECT_GT(config.limits.max_acceleration[i], 0.0);
    EXPECT_LE(config.limits.max_acceleration[i], 50.0);
  }
  const Vector3 tool = tipPose(config.chain, config.q_start).p_AB;
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(said["tool_home_m"][static_cast<std::size_t>(i)].get<double>(), tool[i], 1e-5);
  const RunFigures run = simulate(scene, [](const CycleRecord&) {}).figures;
  EXPECT_EQ(run.end.fault, Fault::kNone);
}

TEST_F(InitTest, OfAllArmsThatComeAlongTheSceneRuns) {
  int arms = 0;
  const std::filesystem::path robots = TACTUS_SOURCE_DIR "/config/robots";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(robots)) {
    if (entry.path().extension() != ".urdf") continue;
    SCOPED_TRACE(entry.path());
    ++arms;
    const std::string name = entry.path().stem();
    Lines more;
    if (name == "ur5e" || name == "kuka_iiwa7") more = {"--tip", "flange"};
    if (name == "planar3") more = {"--tip", "tip"};
    const Json said = init(entry.path(), more);
    EXPECT_TRUE(said["assumed_limits"].empty());
    EXPECT_EQ(said["written"].size(), 2u);
    expectGood(written(), said);
    clear();
  }
  EXPECT_GE(arms, 6);
}

TEST_F(InitTest, OfDrawnChainsTheSceneRuns) {
  test::Random random(77);
  int completed = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const int joints = i < 30 ? 2 + i / 2 : random.integer(2, 16);
    const std::string urdf = put("drawn arm.urdf", test::randomUrdf(random, joints));
    const Json said = init(urdf);
    completed += said["assumed_limits"].empty() ? 0 : 1;
    EXPECT_EQ(said["joints"].size(), static_cast<std::size_t>(joints));
    EXPECT_EQ(said["tip"], "tool");
    expectGood(written(), said);
    if (HasFailure()) break;
    clear();
  }
  EXPECT_GT(completed, 20);
  EXPECT_LT(completed, 200);
}

TEST_F(InitTest, SaysWhatItAssumedWhereItStands) {
  const std::string urdf = put("two.urdf", R"(<robot name="two"><link name="base"/><link name="a"/>
  <link name="b"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="a"/>
    <axis xyz="0 1 0"/><limit lower="-0.2" upper="0.4" velocity="0" effort="7"/></joint>
  <joint name="turn" type="revolute"><parent link="a"/><child link="b"/></joint></robot>)");
  const Json said = init(urdf);
  EXPECT_EQ(said["assumed_limits"], Json::parse(R"([{"joint": "slide", "limits": "velocity"},
                            {"joint": "turn", "limits": "lower, upper, velocity"}])"));
  EXPECT_EQ(said["joints"][0]["lower"], -0.2);
  EXPECT_EQ(said["joints"][0]["max_effort"], 7.0);
  const std::string robot = folder_.content("arm/robot.yaml");
  EXPECT_NE(robot.find("ASSUMED in the URDF's copy"), std::string::npos);
  EXPECT_NE(robot.find("lower, upper, velocity of joint turn"), std::string::npos);
  EXPECT_NE(
      folder_.content("arm/two_with_limits.urdf").find("<!-- ASSUMED by tactus init: velocity"),
      std::string::npos);
}

TEST_F(InitTest, WarnsAsACheckDoes) {
  const std::string urdf = put("degrees.urdf", R"(<robot name="r"><link name="a"/><link name="b"/>
  <link name="c"/><joint name="up" type="revolute"><parent link="a"/><child link="b"/>
    <axis xyz="0 0 1"/><limit lower="-170" upper="170" velocity="1"/></joint>
  <joint name="turn" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
    <origin xyz="0.3 0 0"/><limit lower="-1" upper="1" velocity="1"/></joint></robot>)");
  const Json said = init(urdf);
  ASSERT_EQ(said["warnings"].size(), 1u);
  EXPECT_NE(said["warnings"][0].get<std::string>().find("are they in degrees?"), std::string::npos);
  EXPECT_EQ(said["warnings"], Json(checkArm(written())));
  clear();
  std::string output;
  test::runCommand(addInitCommand, {"init", urdf, "-o", folder_.path() + "/arm"}, output);
  EXPECT_NE(output.find("\nwarning   limits of joints more than four turns"), std::string::npos)
      << output;
}

/// A file that says one end has said it, also where that is zero.
TEST_F(InitTest, AnEndThatTheUrdfHasIsNeverMoved) {
  const auto limitsBy = [&](const std::string& written) {
    const Json said = init(put("ends.urdf", R"(<robot name="r"><link name="a"/><link name="b"/>
  <link name="c"/><joint name="slide" type="prismatic"><parent link="a"/><child link="b"/>
    <axis xyz="0 1 0"/><limit )" + written + R"( velocity="0.1"/></joint>
  <joint name="turn" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
    <origin xyz="0.3 0 0"/><limit lower="-1" upper="1" velocity="1"/></joint></robot>)"));
    clear();
    const Json& joint = said["joints"][0];
    const Json assumed =
        said["assumed_limits"].empty() ? Json::object() : said["assumed_limits"][0];
    return Json{joint["lower"], joint["upper"], assumed.value("limits", "")};
  };
  EXPECT_EQ(limitsBy(R"(lower="0")"), (Json{0.0, 0.25, "upper"}));
  EXPECT_EQ(limitsBy(R"(upper="0")"), (Json{-0.25, 0.0, "lower"}));
  EXPECT_EQ(limitsBy(R"(upper="0.123456789")"), (Json{-0.25, 0.123456789, "lower"}));
  EXPECT_EQ(limitsBy(R"(lower="0.5")"), (Json{0.5, 0.75, "upper"}));
  EXPECT_EQ(limitsBy(R"(lower="0" upper="0")"), (Json{-0.25, 0.25, "lower, upper"}));
  EXPECT_EQ(limitsBy(""), (Json{-0.25, 0.25, "lower, upper"}));
  EXPECT_EQ(limitsBy(R"(lower="0" upper="0.3")"), (Json{0.0, 0.3, ""}));
}

/// There "..", by the names, leads to another folder than on the disk.
TEST_F(InitTest, FolderBehindALinkHasARobotThatLoads) {
  std::filesystem::create_directories(folder_.path() + "/disk/deep");
  std::filesystem::create_symlink("disk/deep", folder_.path() + "/arm");
  std::filesystem::copy_file(TACTUS_SOURCE_DIR "/config/robots/planar2/planar2.urdf",
                             folder_.path() + "/planar2.urdf");
  init(folder_.path() + "/planar2.urdf");
  EXPECT_EQ(written().joint_names.size(), 2u);
  EXPECT_EQ(loadScene(folder_.path() + "/disk/deep/scene.yaml", {}).joint_names.size(), 2u);
}

TEST_F(InitTest, NothingIsOverwrittenOrLeftHalfDone) {
  const std::string urdf = TACTUS_SOURCE_DIR "/config/robots/planar2/planar2.urdf";
  std::filesystem::create_directory(folder_.path() + "/arm");
  put("arm/scene.yaml", "mine");
  EXPECT_NE(refusal(urdf).find("scene.yaml:1:1: -: is there already, expected another folder"),
            std::string::npos);
  EXPECT_EQ(folder_.content("arm/scene.yaml"), "mine");
  EXPECT_FALSE(folder_.has("arm/robot.yaml"));
}

TEST_F(InitTest, WhatNoArmCanBeMadeOfIsRefusedAndNothingWritten) {
  const auto expectRefusal = [&](const std::string& urdf, const Lines& more, const char* problem) {
    const std::string error = refusal(urdf, more);
    EXPECT_NE(error.find(problem), std::string::npos) << error;
    EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 0) << error;
    EXPECT_FALSE(folder_.has("arm"));
  };
  const std::string iiwa = TACTUS_SOURCE_DIR "/config/robots/kuka_iiwa7/kuka_iiwa7.urdf";
  expectRefusal(iiwa, {},
                "tip: 2 links end the arm: 'flange' (7 joints), 'forearm_cover' (4 joints)");
  expectRefusal(iiwa, {"--tip", "flang"}, "expected perhaps 'flange'");
  expectRefusal(iiwa, {"--tip", "link1"}, "1 moving joints");
  expectRefusal(folder_.path() + "/none.urdf", {}, "No such file");
  expectRefusal(put("no.urdf", "<robot>"), {}, "no.urdf:");
  expectRefusal(put("ball.urdf", R"(<robot name="r"><link name="a"/><link name="b"/>
  <joint name="j" type="ball"><parent link="a"/><child link="b"/></joint></robot>)"),
                {}, "'ball' on the way to the tip");
  expectRefusal(put("bad.urdf", R"(<robot name="r"><link name="a"/><link name="b"/>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/>
  <limit lower="2" upper="1" velocity="1"/></joint></robot>)"),
                {}, "lower 2 is not below upper 1");
  for (const std::string limit : {"lower", "upper", "velocity"})
    expectRefusal(put("abc.urdf", R"(<robot name="r"><link name="a"/><link name="b"/>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/>
  <limit )" + limit + R"(="abc"/></joint></robot>)"),
                  {}, ("abc.urdf:3:3: joint.j.limit." + limit + ": 'abc' is no number").c_str());
}

TEST_F(InitTest, FoldersThatWereMadeAreGoneAfterAFailure) {
  const std::string urdf = TACTUS_SOURCE_DIR "/config/robots/planar2/planar2.urdf";
  put("file", "mine");
  std::filesystem::create_directory(folder_.path() + "/kept");
  for (const std::string& folder :
       {"/file/a/b" + std::string(), "/kept/a/" + std::string(300, 'b')}) {
    std::string output;
    EXPECT_THROW(
        test::runCommand(addInitCommand, {"init", urdf, "-o", folder_.path() + folder}, output),
        InputError)
        << folder;
  }
  EXPECT_TRUE(folder_.has("kept"));
  EXPECT_FALSE(folder_.has("kept/a"));
}

/// What is commented out has to be right, too, once it is filled in.
TEST_F(InitTest, WhatIsToBeFilledInLoadsOnceItIs) {
  init(TACTUS_SOURCE_DIR "/config/robots/planar2/planar2.urdf");
  const auto uncommented = [&](const std::string& name, const std::string& from) {
    std::string text = folder_.content(name);
    const std::size_t begin = text.find(from);
    EXPECT_NE(begin, std::string::npos);
    std::string result = text.substr(0, begin);
    std::istringstream rest(text.substr(begin));
    for (std::string line; std::getline(rest, line);)
      result +=
          (line.starts_with("# - ") || line.starts_with("#   are free") ? line : line.substr(2)) +
          "\n";
    return result;
  };
  std::string robot = uncommented("arm/robot.yaml", "# can:");
  const auto fill = [&](const std::string& after, const std::string& value) {
    const std::size_t key = robot.find(after + ": FILL_IN");
    ASSERT_NE(key, std::string::npos) << after;
    robot.replace(key + after.size() + 2, 7, value);
  };
  for (int i = 0; i < 2; ++i) fill("counts_per_rad", "1e5");
  // It stays where `calibrate fit --write` writes the rows, and has to be right then, too.
  EXPECT_NE(robot.find("calibration:             # of no module as init writes it: `calibrate fit"),
            std::string::npos);
  fill("interface", "can0");
  fill("link", "lower");
  fill("length_m", "0.3");
  fill("cover_radius_m", "0.05");
  fill("chip", "gpiochip0");
  for (const char* line : {"4", "5", "6"}) {
    fill("{line", line);
    fill("active_low", "false");
  }
  EXPECT_EQ(robot.find("FILL_IN:"), std::string::npos);
  put("arm/robot.yaml", robot);
  put("arm/scene.yaml", uncommented("arm/scene.yaml", "# controller:"));
  const Scene scene = written();
  EXPECT_EQ(scene.module_links, Lines{"lower"});
  ASSERT_TRUE(scene.hardware && scene.hardware->gpio);
  EXPECT_EQ(scene.hardware->drives[1].node_id, 2);
  // An arm with as many joints as its task has components gives way, too.
  ASSERT_TRUE(scene.controller.force_control);
  EXPECT_EQ(scene.controller.force_control->variant, Variant::kNullLimit);
  EXPECT_EQ(scene.hardware->tactile_modules[0].first_id, 0x100u);
}

}  // namespace
}  // namespace tactus
