#include <gtest/gtest.h>

#include "support/scene_files.h"
#include "support/shipped_scene.h"
#include "tactus/scene/urdf_capsules.h"

namespace tactus {
namespace {

using test::loadError;
using test::replaced;
using test::SceneFiles;

SceneFiles filesWith(const std::string& capsules) {
  SceneFiles files;
  files.robot += "collision_capsules:\n" + capsules;
  return files;
}

const std::string kTwoCapsules =
    "  - {link: bend, from_m: [0, 0, 0.1], to_m: [0, 0.2, 0], radius_m: 0.03}\n"
    "  - {link: base, from_m: [0, 0, 0], to_m: [0, 0, 0], radius_m: 0.1}\n";

TEST(CapsuleLoad, PlacesThemByTheirJoints) {
  const Scene scene = filesWith(kTwoCapsules).load();
  ASSERT_EQ(scene.plant.capsules.size(), 2u);
  EXPECT_EQ(scene.capsule_links, (std::vector<std::string>{"bend", "base"}));
  const LinkCapsule& bend = scene.plant.capsules[0];
  EXPECT_EQ(bend.link.joint, 1);
  EXPECT_NEAR(bend.link.X_JointFrame.p_AB.x(), 0.5, 1e-15);
  EXPECT_NEAR((bend.link.X_JointFrame.R_AB * bend.p_LinkFrom - Vector3(0, -0.1, 0)).norm(), 0.0,
              1e-12);
  EXPECT_EQ(bend.radius_m, 0.03);
  EXPECT_EQ(scene.plant.capsules[1].link.joint, -1);
  EXPECT_TRUE(SceneFiles().load().plant.capsules.empty());
}

TEST(CapsuleLoad, CoversThatNobodyReadsAreMoreOfThem) {
  SceneFiles files = filesWith(kTwoCapsules);
  const std::size_t from = files.scene.find("controller:");
  files.scene.erase(from, files.scene.find("simulation:") - from);
  const Scene scene = files.load();
  ASSERT_EQ(scene.plant.capsules.size(), 3u);
  EXPECT_EQ(scene.capsule_links.back(), "cover");
  EXPECT_EQ(scene.plant.capsules.back().p_LinkTo.x(), 0.4);
  files.robot = test::kRobotText;
  EXPECT_TRUE(files.load().plant.capsules.empty());
}

TEST(CapsuleLoad, EndsAsOneLine) {
  const auto expectError = [](const std::string& from, const std::string& to,
                              const std::string& part) {
    SceneFiles files = filesWith(replaced(kTwoCapsules, from, to));
    const std::string error = loadError(files.sources());
    EXPECT_NE(error.find("robot.yaml:"), std::string::npos) << error;
    EXPECT_NE(error.find(part), std::string::npos) << part << " in " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  };
  expectError("link: bend", "link: bent",
              "collision_capsules[0].link: 'bent' is no link of robot.urdf, expected perhaps "
              "'bend'");
  expectError("link: bend", "link: gripper",
              "collision_capsules[0].link: 'gripper' moves with joint 'grip'");
  expectError("0.03", "-0.03", "collision_capsules[0].radius_m: '-0.03' is out of range");
  expectError("0.03", "0", "collision_capsules[0].radius_m: '0' is out of range");
  expectError("[0, 0.2, 0]", "[0, .inf, 0]", "collision_capsules[0].to_m[1]: '.inf'");
  expectError("to_m: [0, 0.2, 0], ", "", "collision_capsules[0].to_m: is missing");
}

/// Two boxes, one of them turned, a cylinder, a ball and a mesh.
std::string withCollisions() {
  const auto collision = [](const std::string& origin, const std::string& shape) {
    return "<collision>" + origin + "<geometry>" + shape + "</geometry></collision>";
  };
  std::string urdf =
      replaced(test::kUrdfText, "<link name=\"link1\"/>",
               "<link name=\"link1\">" +
                   collision("<origin xyz=\"0.1 0 0\" rpy=\"0 0 1.5707963267948966\"/>",
                             "<box size=\"0.4 0.1 0.06\"/>") +
                   collision("", "<mesh filename=\"a.stl\"/>") + "</link>");
  urdf = replaced(
      urdf, "<link name=\"bend\"/>",
      "<link name=\"bend\">" +
          collision("<origin xyz=\"0 0 0.1\"/>", "<cylinder radius=\"0.05\" length=\"0.3\"/>") +
          "</link>");
  urdf =
      replaced(urdf, "<link name=\"cover\"/>",
               "<link name=\"cover\">" + collision("", "<box size=\"0.4 0.1 0.1\"/>") + "</link>");
  urdf = replaced(urdf, "<link name=\"gripper\"/>",
                  "<link name=\"gripper\">" + collision("", "<sphere radius=\"1\"/>") + "</link>");
  return replaced(urdf, "<link name=\"tool\"/>",
                  "<link name=\"tool\">" + collision("", "<sphere radius=\"0.07\"/>") + "</link>");
}

TEST(CapsuleProposal, IsMadeOfTheCollisionGeometry) {
  SceneFiles files;
  files.urdf = withCollisions();
  EXPECT_EQ(proposeCapsules(files.load()),
            "# For robot.yaml. From the collision geometry of robot.urdf; edges are rounded: look "
            "at each.\n"
            "collision_capsules:\n"
            "  - {link: link1, from_m: [0.1, -0.15, 0], to_m: [0.1, 0.15, 0], radius_m: 0.05}\n"
            "  # link1: a mesh, of which no capsule is made: measure it\n"
            "  # cover has a tactile module: of this keep what its cover leaves free\n"
            "  # - {link: cover, from_m: [-0.15, 0, 0], to_m: [0.15, 0, 0], radius_m: 0.05}\n"
            "  - {link: bend, from_m: [0, 0, 0], to_m: [0, 0, 0.2], radius_m: 0.05}\n"
            "  - {link: tool, from_m: [0, 0, 0], to_m: [0, 0, 0], radius_m: 0.07}\n");
}

/// As vendors mark places, and with the shape that some programs add to the URDF's.
TEST(CapsuleProposal, LeavesOutShapesWithoutSizeAndTakesCapsules) {
  for (const char* const shape :
       {"<box size=\"0 0 0\"/>", "<box size=\"0 0 0.1\"/>", "<sphere radius=\"0.0\"/>",
        "<cylinder radius=\"0\" length=\"0.1\"/>"}) {
    SceneFiles files;
    files.urdf = replaced(withCollisions(), "<sphere radius=\"0.07\"/>", shape);
    const std::string proposed = proposeCapsules(files.load());
    EXPECT_NE(proposed.find("  # tool: a shape without size, of which no capsule is made"),
              std::string::npos)
        << shape << proposed;
    files.robot += proposed;
    EXPECT_EQ(files.load().plant.capsules.size(), 2u) << shape;
  }
  SceneFiles files;
  files.urdf = replaced(withCollisions(), "<sphere radius=\"0.07\"/>",
                        "<capsule radius=\"0.07\" length=\"0.2\"/>");
  EXPECT_NE(proposeCapsules(files.load())
                .find("{link: tool, from_m: [0, 0, -0.1], to_m: [0, 0, 0.1], radius_m: 0.07}"),
            std::string::npos);
  for (const char* const shape : {"<box size=\"0 -1 0\"/>", "<sphere radius=\"-0.1\"/>"}) {
    files.urdf = replaced(withCollisions(), "<sphere radius=\"0.07\"/>", shape);
    const Scene scene = files.load();
    EXPECT_THROW(proposeCapsules(scene), InputError) << shape;
  }
}

/// As of most arms, whose vendors draw meshes alone.
TEST(CapsuleProposal, OfMeshesAloneIsAcceptedToo) {
  SceneFiles files;
  files.urdf =
      replaced(files.urdf, "<link name=\"link1\"/>",
               "<link name=\"link1\"><collision><geometry><mesh filename=\"a.stl\"/></geometry>"
               "</collision></link>");
  const std::string proposed = proposeCapsules(files.load());
  EXPECT_NE(proposed.find("# link1: a mesh"), std::string::npos);
  files.robot += proposed;
  EXPECT_TRUE(files.load().plant.capsules.empty());
}

TEST(CapsuleProposal, IsAcceptedAsItIs) {
  SceneFiles files;
  files.urdf = withCollisions();
  SceneFiles with = files;
  with.robot += proposeCapsules(files.load());
  EXPECT_EQ(with.load().plant.capsules.size(), 3u);
  for (const char* scene : {"scenario1_null_space", "robots/ur5e_contact", "robots/planar2_contact",
                            "robots/snake16_contact", "robots/kuka_iiwa7_contact"}) {
    const Scene shipped = test::shippedScene(scene);
    std::vector<SourceFile> sources = shipped.sources;
    sources[sources.size() - 2].text += proposeCapsules(shipped);
    const Scene proposed = loadScene(sources, {});
    EXPECT_GT(proposed.plant.capsules.size(), 0u) << scene;
  }
}

TEST(CapsuleProposal, LeavesOutWhatTheCoverTakesUp) {
  const std::string text = proposeCapsules(SceneFiles().load());
  EXPECT_NE(text.find("has no collision geometry"), std::string::npos);
  // The link behind the shoulder is 0.5 m long, its cover lies from 0.05 to 0.45 m.
  EXPECT_NE(text.find("{link: link2, from_m: [0, 0, 0], to_m: [0.05, 0, 0], radius_m: 0.05}"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("{link: link2, from_m: [0.45, 0, 0], to_m: [0.5, 0, 0], radius_m: 0.05}"),
            std::string::npos)
      << text;
}

TEST(CapsuleProposal, SaysThatTheSceneReadsNoModule) {
  const std::string part = "reads no tactile module";
  EXPECT_NE(proposeCapsules(test::shippedScene("free_motion")).find(part), std::string::npos);
  EXPECT_EQ(proposeCapsules(test::shippedScene("scenario1_none")).find(part), std::string::npos);
}

TEST(CapsuleProposal, RefusesGeometryThatIsNone) {
  for (const char* bad : {"-1", "nan", "wide"}) {
    SceneFiles files;
    files.urdf =
        replaced(withCollisions(), "radius=\"0.07\"", "radius=\"" + std::string(bad) + "\"");
    try {
      proposeCapsules(files.load());
      ADD_FAILURE() << bad;
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("robot.urdf:"), std::string::npos) << text;
      EXPECT_NE(text.find("link.tool.collision.geometry.sphere.radius"), std::string::npos) << text;
    }
  }
}

TEST(LinkErrors, LengthenTheSimulatedLinksAlone) {
  const Scene scene = SceneFiles().load({{"simulation.link_length_errors_m", "[0.03, 0, -0.1]"}});
  ASSERT_TRUE(scene.plant.chain);
  const JointVector q = JointVector::Zero(3);
  const Vector3 believed = tipPose(scene.controller.chain, q).p_AB;
  const Vector3 real = tipPose(*scene.plant.chain, q).p_AB;
  const double share = 1.0 - 0.1 / std::hypot(0.3, 0.1);
  EXPECT_NEAR(believed.x(), 0.3 + 0.5 + 0.3, 1e-12);
  EXPECT_NEAR(real.x(), 0.33 + 0.5 + share * 0.3, 1e-12);
  EXPECT_FALSE(SceneFiles().load().plant.chain);
}

TEST(LinkErrors, EndAsOneLine) {
  const auto expectError = [](const std::string& value, const std::string& part) {
    const std::string error =
        loadError(SceneFiles().sources(), {{"simulation.link_length_errors_m", value}});
    EXPECT_NE(error.find("simulation.link_length_errors_m"), std::string::npos) << error;
    EXPECT_NE(error.find(part), std::string::npos) << error;
  };
  expectError("[0.1, 0]", "a list of 2");
  expectError("[0, -0.5, 0]", "the link behind joint 'shoulder' is 0.5 m long, expected 0, or");
  expectError("[0, .nan, 0]", "not a number");
  SceneFiles files;
  files.urdf = replaced(files.urdf, "<origin xyz=\"0.3 0.1 0\"/>", "");
  const std::string error =
      loadError(files.sources(), {{"simulation.link_length_errors_m", "[0, 0, 0.1]"}});
  EXPECT_NE(error.find("the link behind joint 'roll' is 0 m long"), std::string::npos) << error;
}

TEST(ObstacleLoad, KnowsItsShapes) {
  const auto obstacleOf = [](const std::string& text) {
    return SceneFiles().load({{"simulation.obstacles", "[" + text + "]"}}).plant.obstacles.at(0);
  };
  EXPECT_EQ(obstacleOf("{sphere: {center_m: [1, 2, 3], radius_m: 0.2}, stiffness_N_per_m: 5}")
                .sphere->center_m,
            Vector3(1, 2, 3));
  const ObstacleConfig post =
      obstacleOf("{post: {foot_m: [1, 2, 3], height_m: 0.5}, stiffness_N_per_m: 5}");
  EXPECT_EQ(post.post->axis, Vector3(0, 0, 1));
  EXPECT_EQ(post.post->radius_m, 0.0);
  EXPECT_FALSE(post.sphere || post.line || post.plane);
  EXPECT_EQ(obstacleOf("{plane: {point_m: [1, 0, 0], normal: [-2, 0, 0]}, stiffness_N_per_m: 5}")
                .plane->normal,
            Vector3(-2, 0, 0));
  EXPECT_EQ(obstacleOf("{line: {point_m: [1, 0, 0], direction: [0, 1, 0]}, stiffness_N_per_m: 5}")
                .line->direction,
            Vector3(0, 1, 0));
}

TEST(ObstacleLoad, EndsAsOneLine) {
  const auto expectError = [](const std::string& shape, const std::string& part) {
    const std::string error =
        loadError(SceneFiles().sources(),
                  {{"simulation.obstacles", "[{" + shape + "stiffness_N_per_m: 5}]"}});
    EXPECT_NE(error.find("simulation.obstacles[0]." + part), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  };
  const std::string one = ", expected one of x_m and y_m, sphere, plane, line, post";
  const std::string ball = "sphere: {center_m: [0, 0, 0], radius_m: 1}, ";
  const std::string bar = "post: {foot_m: [0, 0, 0], height_m: 1}, ";
  expectError("", "x_m: is missing" + one);
  expectError("x_m: 1, ", "y_m: is missing" + one);
  expectError(ball + bar, "post: a second shape besides sphere" + one);
  expectError(ball + "y_m: 1, ", "y_m: a second shape besides sphere" + one);
  expectError("sphere: {center_m: [0, 0, 0], radius_m: -1}, ", "sphere.radius_m: '-1'");
  expectError("sphere: {center_m: [0, .nan, 0], radius_m: 1}, ", "sphere.center_m[1]: '.nan'");
  expectError("post: {foot_m: [0, 0, 0], height_m: 0}, ", "post.height_m: '0'");
  expectError("post: {foot_m: [0, 0, 0], height_m: 1, axis: [0, 0, 0]}, ",
              "post.axis: has no length, expected a vector other than zero");
  expectError("plane: {point_m: [0, 0, 0], normal: [0, 0, 0]}, ", "plane.normal: has no length");
  expectError("plane: {point_m: [0, 0, 0]}, ", "plane.normal: is missing");
  expectError("line: {point_m: [0, 0, 0], direction: [0, 0, 1e-9]}, ",
              "line.direction: has no length");
}

}  // namespace
}  // namespace tactus
