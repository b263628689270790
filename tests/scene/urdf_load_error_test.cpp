#include <gtest/gtest.h>

#include "support/scene_files.h"

namespace tactus {
namespace {

using test::BrokenText;
using test::SceneFiles;

class BrokenUrdf : public testing::TestWithParam<BrokenText> {};

TEST_P(BrokenUrdf, EndsAsOneLine) {
  SceneFiles files;
  files.urdf = test::replaced(files.urdf, GetParam().from, GetParam().to);
  test::expectError(test::loadError(files.sources()), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Structure, BrokenUrdf,
    testing::Values(
        BrokenText{"</robot>", "", "robot.urdf:", "", "well-formed XML"},
        BrokenText{"<robot name=\"three\">", "<robt name=\"three\">", "robot.urdf:", "",
                   "well-formed XML"},
        BrokenText{"<link name=\"link3\"/>", "<link name=\"link2\"/>",
                   "robot.urdf:3:42: link.link2: ", "a second link of this name", "unique names"},
        BrokenText{"<link name=\"link3\"/>", "<link/>",
                   "robot.urdf:3:42: link.name: ", "is missing", "an attribute name"},
        BrokenText{"<joint name=\"shoulder\"", "<joint name=\"lift\"",
                   "robot.urdf:11:3: joint.lift: ", "a second joint of this name", "unique names"},
        BrokenText{"<child link=\"spacer\"/>", "<child link=\"spacr\"/>",
                   "robot.urdf:9:27: joint.spacer_fixed.child: ", "'spacr' is no link",
                   "the name of a <link>"},
        BrokenText{"<child link=\"spacer\"/>", "<child/>",
                   "robot.urdf:9:27: joint.spacer_fixed.child.link: ", "is missing",
                   "an attribute link"},
        BrokenText{"<child link=\"spacer\"/>", "",
                   "robot.urdf:8:3: joint.spacer_fixed.child: ", "is missing", "an element <child"},
        BrokenText{"<child link=\"spacer\"/>", "<child link=\"spacer\"/><child link=\"tool\"/>",
                   "robot.urdf:9:49: joint.spacer_fixed.child: ", "given twice", "once"},
        BrokenText{"name=\"roll\" type=\"continuous\"", "name=\"roll\"",
                   "robot.urdf:22:3: joint.roll.type: ", "is missing", "an attribute type"},
        BrokenText{"<parent link=\"tool\"/><child link=\"gripper\"/>",
                   "<parent link=\"gripper\"/><child link=\"tool\"/>",
                   "robot.urdf:28:3: joint.grip.child: ",
                   "'tool' is already the child of joint 'tool_fixed'", "one parent a link"},
        BrokenText{"<parent link=\"base\"/>", "<parent link=\"tool\"/>",
                   "robot.urdf:4:3: joint.lift: ", "hangs on a circle of joints",
                   "to hang on the root"},
        BrokenText{"<parent link=\"bend\"/><child link=\"link3\"/>",
                   "<parent link=\"tool\"/><child link=\"link3\"/>",
                   "robot.urdf:22:3: joint.roll: ", "hangs on a circle of joints",
                   "to hang on the root"},
        BrokenText{"<joint name=\"grip\" type=\"clutch\"><parent link=\"tool\"/>"
                   "<child link=\"gripper\"/></joint>",
                   "", "robot.urdf:1:1: robot: ", "links 'base' and 'gripper' both have no parent",
                   "one root link"}));

INSTANTIATE_TEST_SUITE_P(
    Numbers, BrokenUrdf,
    testing::Values(
        BrokenText{"<axis xyz=\"0 0 2\"/>", "<axis xyz=\"0 0 0\"/>",
                   "robot.urdf:6:5: joint.lift.axis.xyz: ", "the axis has no length",
                   "other than zero"},
        BrokenText{"<axis xyz=\"0 0 2\"/>", "<axis xyz=\"0 0 nan\"/>",
                   "robot.urdf:6:5: joint.lift.axis.xyz: ", "'0 0 nan' is no vector",
                   "three numbers"},
        BrokenText{"<axis xyz=\"0 0 2\"/>", "<axis xyz=\"0 0\"/>",
                   "robot.urdf:6:5: joint.lift.axis.xyz: ", "'0 0' is no vector", "three numbers"},
        BrokenText{"<axis xyz=\"0 0 2\"/>", "<axis xyz=\"0 0 2\" xyz=\"0 0 1\"/>",
                   "robot.urdf:6:5: joint.lift.axis.xyz: ", "given twice", "once"},
        BrokenText{"xyz=\"0.2 0 0\"", "xyz=\"0.2 0 0 0\"",
                   "robot.urdf:13:5: joint.shoulder.origin.xyz: ", "'0.2 0 0 0' is no vector",
                   "three numbers"},
        BrokenText{"xyz=\"0.2 0 0\"", "xyz=\"200 mm 0 0\"",
                   "robot.urdf:13:5: joint.shoulder.origin.xyz: ", "'200 mm 0 0' is no vector",
                   "three numbers"},
        BrokenText{"xyz=\"0.2 0 0\"", "xyz=\"1e300 0 0\"",
                   "robot.urdf:13:5: joint.shoulder.origin.xyz: ", "'1e300 0 0' is out of range",
                   "from -1000 to 1000"},
        BrokenText{"rpy=\"0 0 0\"", "rpy=\"0 0 inf\"",
                   "robot.urdf:13:5: joint.shoulder.origin.rpy: ", "'0 0 inf' is no vector",
                   "three numbers"},
        BrokenText{"lower=\"-2\" upper=\"2\"", "lower=\"2\" upper=\"-2\"",
                   "robot.urdf:14:24: joint.shoulder.limit: ", "lower 2 is not below upper -2",
                   "lower < upper"},
        BrokenText{"lower=\"-2\" upper=\"2\"", "lower=\"2\" upper=\"2\"",
                   "robot.urdf:14:24: joint.shoulder.limit: ", "lower 2 is not below upper 2",
                   "lower < upper"},
        BrokenText{"lower=\"-2\" upper=\"2\"", "lower=\"-2\"",
                   "robot.urdf:14:24: joint.shoulder.limit.upper: ", "is missing", "a number"},
        BrokenText{"lower=\"-2\" upper=\"2\"", "lower=\"-2 0\" upper=\"2\"",
                   "robot.urdf:14:24: joint.shoulder.limit.lower: ", "'-2 0' is no number",
                   "a number"},
        BrokenText{"lower=\"-2\" upper=\"2\"", "lower=\"-2\" upper=\"1e16\"",
                   "robot.urdf:14:24: joint.shoulder.limit.upper: ", "'1e16' is out of range",
                   "a number from -1000000 to 1000000"},
        BrokenText{"<limit lower=\"-2\" upper=\"2\" velocity=\"1.5\"/>", "",
                   "robot.urdf:11:3: joint.shoulder.limit.lower: ", "is missing", "a number"},
        BrokenText{"velocity=\"1.5\"", "velocity=\"0\"",
                   "robot.urdf:14:24: joint.shoulder.limit.velocity: ", "is not positive", "> 0"},
        BrokenText{" velocity=\"1.5\"", "",
                   "robot.urdf:14:24: joint.shoulder.limit.velocity: ", "is missing", "a number"},
        BrokenText{"<limit velocity=\"2\"/>", "",
                   "robot.urdf:22:3: joint.roll.limit.velocity: ", "is missing", "a number"},
        BrokenText{"type=\"revolute\"", "type=\"planar\"", "robot.urdf:11:3: joint.shoulder.type: ",
                   "'planar' on the way to the tip", "prismatic, revolute, continuous or fixed"},
        BrokenText{"type=\"revolute\"", "type=\"floating\"",
                   "robot.urdf:11:3: joint.shoulder.type: ", "'floating' on the way to the tip",
                   "prismatic, revolute, continuous or fixed"},
        BrokenText{"<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 1\"/><mimic joint=\"lift\"/>",
                   "robot.urdf:14:24: joint.shoulder.mimic: ", "follows another one",
                   "that move on their own"}));

TEST(BrokenUrdfFile, HostileName) {
  SceneFiles files;
  files.urdf = test::replaced(files.urdf, "name=\"shoulder\"", "name=\"a: b&#10;c\"");
  files.urdf = test::replaced(files.urdf, "velocity=\"1.5\"", "velocity=\"fast\"");
  test::expectError(test::loadError(files.sources()),
                    {"", "", "robot.urdf:14:24: joint.a\\x3a b\\x0ac.limit.velocity: ",
                     "'fast' is no number", "a number"});
}

TEST(BrokenUrdfFile, EndlessNames) {
  const struct {
    std::string from, to, place;
  } cases[] = {
      {"name=\"shoulder\"", "name=\"@\"", "robot.urdf:11:3: joint.name: "},
      {"<robot name=\"three\"", "<robot name=\"@\"", "robot.urdf:1:1: robot.name: "},
      {"<link name=\"spacer\"/>", "<link name=\"spacer\"/><link name=\"@\"/>",
       "robot.urdf:2:63: link.name: "},
  };
  for (const auto& c : cases) {
    SceneFiles files;
    files.urdf =
        test::replaced(files.urdf, c.from, test::replaced(c.to, "@", std::string(70000, 'n')));
    test::expectError(test::loadError(files.sources()),
                      {c.from, c.to, c.place, "70000 bytes long", "at most 255"});
  }
  SceneFiles files;
  const std::string longest(255, 'n');
  files.urdf = test::replaced(files.urdf, "name=\"shoulder\"", "name=\"" + longest + "\"");
  EXPECT_EQ(files.load().joint_names[1], longest);
}

TEST(BrokenUrdfFile, OtherDocumentElement) {
  SceneFiles files;
  files.urdf = "<sdf></sdf>\n";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "robot.urdf:1:1: -: ", "the document element is 'sdf'", "<robot>"});
}

TEST(BrokenUrdfFile, SomethingAfterItsEnd) {
  SceneFiles files;
  files.urdf += "<!-- a remark may be there -->\n";
  EXPECT_NO_THROW(files.load());
  files.urdf += "<robot name=\"other\"/>\n";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "robot.urdf:", "'robot' after the end of <robot>", "one document"});
}

TEST(BrokenUrdfFile, Empty) {
  SceneFiles files;
  files.urdf = "";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "robot.urdf:1:1: -: ", "No document element", "well-formed XML"});
  files.urdf = "<robot name=\"none\"/>";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "robot.urdf:1:1: robot: ", "has no link", "links and joints"});
}

TEST(BrokenUrdfFile, NoRoot) {
  SceneFiles files;
  files.urdf = test::replaced(files.urdf, "<link name=\"gripper\"/>", "");
  files.urdf = test::replaced(files.urdf, "<child link=\"gripper\"/>", "<child link=\"base\"/>");
  test::expectError(
      test::loadError(files.sources()),
      {"", "", "robot.urdf:1:1: robot: ", "every link has a parent", "one root link"});
}

TEST(BrokenUrdfFile, NestedDeeply) {
  SceneFiles files;
  files.urdf = "<robot>";
  for (int i = 0; i < 200000; ++i) files.urdf += "<a>";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "robot.urdf:1:", "", "well-formed XML"});
}

TEST(BrokenUrdfFile, Truncated) {
  const SceneFiles whole;
  for (std::size_t length = 0; length + 1 < whole.urdf.size(); ++length) {
    SceneFiles files;
    files.urdf.resize(length);
    const std::string error = test::loadError(files.sources());
    EXPECT_EQ(error.substr(0, 11), "robot.urdf:") << length << " " << error;
    EXPECT_NE(error.find(", expected "), std::string::npos) << error;
  }
}

TEST(BrokenUrdfFile, SeventeenJoints) {
  std::string urdf = "<robot name=\"long\"><link name=\"l0\"/>";
  std::string robot = "urdf: robot.urdf\ntip: l17\nhome: [0, 0]\n";
  for (int i = 1; i <= 17; ++i) {
    const std::string n = std::to_string(i);
    urdf += "<link name=\"l" + n + "\"/><joint name=\"j" + n +
            "\" type=\"continuous\"><parent link=\"l" + std::to_string(i - 1) +
            "\"/><child link=\"l" + n + "\"/><limit velocity=\"1\"/></joint>";
  }
  SceneFiles files;
  files.urdf = urdf + "</robot>";
  files.robot = robot;
  test::expectError(test::loadError(files.sources(), {{"controller", "null"}}),
                    {"", "", "robot.yaml:2:6: tip: ", "17 moving joints", "2 to 16"});
}

}  // namespace
}  // namespace tactus
