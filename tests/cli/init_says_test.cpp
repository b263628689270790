#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/command_run.h"
#include "support/run_folder.h"
#include "tactus/cli/commands.h"

/// What `tactus init` says of what it assumes, and of what has still to be given.
namespace tactus {
namespace {

class InitSaysTest : public ::testing::Test {
 protected:
  std::string put(const std::string& name, const std::string& text) const {
    const std::string path = folder_.path() + "/" + name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  std::string init(const std::string& urdf) const {
    std::string output;
    EXPECT_EQ(
        test::runCommand(addInitCommand, {"init", urdf, "-o", folder_.path() + "/arm"}, output),
        kExitDone);
    return output;
  }

  test::RunFolder folder_;
};

TEST_F(InitSaysTest, SaysWhichJointsADriveHasNoCountsFor) {
  const std::string urdf = put("turns.urdf", R"(<robot name="r"><link name="a"/><link name="b"/>
  <link name="c"/><joint name="round" type="continuous"><parent link="a"/><child link="b"/>
    <axis xyz="0 0 1"/><limit velocity="1"/></joint>
  <joint name="turn" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
    <origin xyz="0.3 0 0"/><limit lower="-1" upper="1" velocity="1"/></joint></robot>)");
  init(urdf);
  const std::string robot = folder_.content("arm/robot.yaml");
  EXPECT_NE(robot.find("joint: round, interface: can0, node_id: 1, counts_per_rad: FILL_IN}  # its "
                       "counts end: needs limits in the URDF\n"),
            std::string::npos)
      << robot;
  EXPECT_NE(robot.find("joint: turn, interface: can0, node_id: 2, counts_per_rad: FILL_IN}\n"),
            std::string::npos);
}

/// Of an arm whose tip is at its reach, which the first motion may not leave.
TEST_F(InitSaysTest, SaysThatRadiiAreAssumedWhereTheyAre) {
  const auto saidOf = [&](const std::string& collision) {
    const std::string urdf = put("two.urdf", R"(<robot name="two"><link name="base">)" + collision +
                                                 R"(</link><link name="a"/><link name="b"/>
  <joint name="up" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1"/></joint>
  <joint name="turn" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.3 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1"/></joint></robot>)");
    const std::string output = init(urdf);
    std::filesystem::remove_all(folder_.path() + "/arm");
    return output;
  };
  const std::string of_lengths = "\nassumed   radii of collision_capsules";
  EXPECT_NE(saidOf("").find(of_lengths), std::string::npos);
  for (const char* shape : {"<mesh filename=\"a.stl\"/>", "<box size=\"0 0 0\"/>"}) {
    const std::string said =
        saidOf("<collision><geometry>" + std::string(shape) + "</geometry></collision>");
    EXPECT_NE(said.find("\nassumed   accelerations"), std::string::npos) << said;
    EXPECT_EQ(said.find(of_lengths), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace tactus
