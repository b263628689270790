#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "tactus/scene/input_error.h"
#include "tactus/scene/scene_loader.h"

/// A small scene, its robot and its URDF as texts, to be broken in one place at a time.
namespace tactus::test {

inline const std::string kSceneText = R"(robot: robot.yaml
start: [0.1, 0.2, 0.3]
task:
  components: [x, y]
  drift_gain_per_s: 5
  trajectory:
    line: {displacement_m: [0, 0.1, 0], speed_m_per_s: 0.05}
redundancy:
  weights: [1, 2, 3]
controller:
  variant: null_task
  time_constant_s: 0.1
  activation_force_N: 3.8
stiffness:
  assumed_N_per_m: 7000
  estimate: {min_N_per_m: 20}
simulation:
  duration_s: 13
  obstacles:
    - {x_m: 0.7, y_m: 0.1, stiffness_N_per_m: 60}
    - {x_m: 0.7, y_m: 0.2, stiffness_N_per_m: 17000, foam: [{stiffness_N_per_m: 1400, until_force_N: 9}]}
)";

/// Of the tactile module, without its interface.
inline const std::string kModuleText = R"(  link: cover
  length_m: 0.4
  cover_radius_m: 0.05
  sample_period_s: 0.005
  calibration:
    - [1, -1, 0, 0, 1, -1, 0, 0]
    - [0, 0, 1, -1, 0, 0, 1, -1]
    - [0, 0, -0.1, 0.1, 0, 0, -0.3, 0.3]
    - [0.1, -0.1, 0, 0, 0.3, -0.3, 0, 0]
)";

inline const std::string kRobotText = R"(urdf: robot.urdf
tip: tool
home: [0, 0.5, -0.5]
limits: {acceleration: [10, 20, 30]}
stiffness_N_per_m: 5000
drives: {position_lag_s: 0.01}
tactile_module:
)" + kModuleText;

/// A prismatic, a revolute and a continuous joint; a fixed joint before each of the last two, a
/// fixed cover beside link2, and a branch with a joint the loader knows nothing about.
inline const std::string kUrdfText = R"(<robot name="three">
  <link name="base"/><link name="link1"/><link name="spacer"/><link name="link2"/>
  <link name="cover"/><link name="bend"/><link name="link3"/><link name="tool"/><link name="gripper"/>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="link1"/>
    <axis xyz="0 0 2"/><limit lower="-1" upper="0.5" velocity="0.7"/>
  </joint>
  <joint name="spacer_fixed" type="fixed">
    <parent link="link1"/><child link="spacer"/><origin xyz="0.1 0 0"/>
  </joint>
  <joint name="shoulder" type="revolute">
    <parent link="spacer"/><child link="link2"/>
    <origin xyz="0.2 0 0" rpy="0 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1.5"/>
  </joint>
  <joint name="cover_fixed" type="fixed">
    <parent link="link2"/><child link="cover"/><origin xyz="0.05 0 0"/>
  </joint>
  <joint name="bend_fixed" type="fixed">
    <parent link="link2"/><child link="bend"/><origin xyz="0.5 0 0" rpy="1.5707963267948966 0 0"/>
  </joint>
  <joint name="roll" type="continuous">
    <parent link="bend"/><child link="link3"/><limit velocity="2"/>
  </joint>
  <joint name="tool_fixed" type="fixed">
    <parent link="link3"/><child link="tool"/><origin xyz="0.3 0.1 0"/>
  </joint>
  <joint name="grip" type="clutch"><parent link="tool"/><child link="gripper"/></joint>
</robot>
)";

/// `text` with the only occurrence of `from` replaced.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  EXPECT_EQ(text.find(from, at + 1), std::string::npos) << "ambiguous: " << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// The module as an entry of the list tactile_modules, around another link and with more lines.
inline std::string moduleEntry(const std::string& link, const std::string& more = "") {
  std::string entry = "  - ";
  for (const char c : replaced(kModuleText, "link: cover", "link: " + link).substr(2) + more) {
    entry += c;
    if (c == '\n') entry += "  ";
  }
  return entry.substr(0, entry.rfind('\n') + 1);
}

/// Of the only module the list of these.
inline std::string withModules(const std::string& robot, const std::string& entries) {
  const std::size_t from = robot.find("tactile_module:");
  const std::size_t gpio = robot.find("gpio:");
  const std::string after = gpio == std::string::npos ? "" : robot.substr(gpio);
  return robot.substr(0, from) + "tactile_modules:\n" + entries + after;
}

struct SceneFiles {
  std::string scene = kSceneText, robot = kRobotText, urdf = kUrdfText;

  std::vector<SourceFile> sources() const {
    return {{"scene.yaml", scene}, {"robot.yaml", robot}, {"robot.urdf", urdf}};
  }
  Scene load(const std::vector<Override>& overrides = {}) const {
    return loadScene(sources(), overrides);
  }
};

/// What the InputError of a load says; empty if it succeeds.
inline std::string loadError(const std::vector<SourceFile>& sources,
                             const std::vector<Override>& overrides = {}) {
  try {
    loadScene(sources, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// One way to break a text, and the error it has to end as. Views, for a list of many strings takes
/// seconds to compile.
struct BrokenText {
  std::string_view from, to;     ///< in the file
  std::string_view place;        ///< `file:line:col: key: `
  std::string_view problem;      ///< in what follows, before the expectation
  std::string_view expectation;  ///< behind ", expected "
};

inline void PrintTo(const BrokenText& broken, std::ostream* stream) {
  *stream << broken.from.substr(0, 80) << " -> " << broken.to.substr(0, 80);
}

inline void expectError(const std::string& error, const BrokenText& broken) {
  SCOPED_TRACE(testing::PrintToString(broken));
  ASSERT_NE(error, "") << "loaded without an error";
  EXPECT_EQ(error.substr(0, broken.place.size()), broken.place) << error;
  const std::size_t comma = error.rfind(", expected ");
  ASSERT_NE(comma, std::string::npos) << error;
  EXPECT_NE(error.substr(0, comma).find(broken.problem, broken.place.size()), std::string::npos)
      << error;
  EXPECT_NE(error.find(broken.expectation, comma), std::string::npos) << error;
  EXPECT_EQ(error.find_first_of("\n\r\t"), std::string::npos) << error;
  EXPECT_LT(error.size(), 500u) << error;
}

}  // namespace tactus::test
