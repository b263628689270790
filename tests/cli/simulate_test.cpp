#include <gtest/gtest.h>

#include <fstream>

#include "support/command_run.h"
#include "support/run_folder.h"
#include "tactus/cli/commands.h"

namespace tactus {
namespace {

/// A URDF's names are somebody else's, and go to a terminal.
TEST(Simulate, NamesOfLinksReachNoTerminalAsCommands) {
  const test::RunFolder folder;
  const auto put = [&](const char* name, const std::string& text) {
    std::ofstream(folder.path() + "/" + name) << text;
  };
  put("arm.urdf", R"(<robot name="arm"><link name="a"/><link name="b"/><link name="c&#27;[2J"/>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1"/></joint>
  <joint name="k" type="revolute"><parent link="b"/><child link="c&#27;[2J"/><origin xyz="1 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1"/></joint></robot>)");
  put("robot.yaml",
      "urdf: arm.urdf\ntip: \"c\\e[2J\"\nhome: [0, 1]\ncollision_capsules:\n"
      "  - {link: \"c\\e[2J\", from_m: [0, 0, 0], to_m: [0, 0, 0], radius_m: 0.1}\n");
  put("scene.yaml",
      "robot: robot.yaml\ntask: {components: [x], trajectory: {hold: {}}}\n"
      "simulation: {duration_s: 0.01, obstacles: [{x_m: 1.05, y_m: 0, stiffness_N_per_m: 9}]}\n");
  std::string output;
  test::runCommand(addSimulateCommand,
                   {"simulate", folder.path() + "/scene.yaml", "-o", folder.path() + "/runs"},
                   output);
  EXPECT_NE(output.find("c\\x1b[2J met obstacle 0"), std::string::npos) << output;
  EXPECT_EQ(output.find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace tactus
