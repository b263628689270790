#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "support/scene_files.h"

namespace tactus {
namespace {

using test::SceneFiles;

constexpr double kTolerance = 1e-14;

ChainPose poseAt(const ControllerConfig& config, const Vector3& q) {
  ChainPose pose;
  config.chain.computePose(q, pose);
  return pose;
}

TEST(UrdfLoad, MergesFixedJoints) {
  const ControllerConfig config = SceneFiles{}.load().controller;
  ASSERT_EQ(config.chain.size(), 3);
  const ChainPose pose = poseAt(config, Vector3::Zero());
  EXPECT_NEAR((pose.p_BaseJoint[1] - Vector3(0.3, 0, 0)).norm(), 0.0, kTolerance);
  EXPECT_NEAR((pose.p_BaseJoint[2] - Vector3(0.8, 0, 0)).norm(), 0.0, kTolerance);
  // The last frame is turned by 90 degrees about x, which takes y to z.
  EXPECT_NEAR((framePosition(pose, config.chain.tip()) - Vector3(1.1, 0, 0.1)).norm(), 0.0,
              kTolerance);
}

TEST(UrdfLoad, TakesTypesAndAxes) {
  const ControllerConfig config = SceneFiles{}.load().controller;
  EXPECT_EQ(config.chain.type(0), JointType::kPrismatic);
  EXPECT_EQ(config.chain.type(1), JointType::kRevolute);
  EXPECT_EQ(config.chain.type(2), JointType::kRevolute);
  const ChainPose pose = poseAt(config, Vector3::Zero());
  EXPECT_EQ(pose.axis_Base[0], Vector3(0, 0, 1)) << "normalised";
  EXPECT_EQ(pose.axis_Base[1], Vector3(0, 0, 1));
  EXPECT_EQ(pose.axis_Base[2], Vector3(1, 0, 0)) << "the default of the format";
}

TEST(UrdfLoad, FindsTheCoverBesideTheChain) {
  const ControllerConfig config = SceneFiles{}.load().controller;
  ASSERT_FALSE(config.tactile_modules.empty());
  EXPECT_EQ(config.tactile_modules.front().link.joint, 1);
  EXPECT_EQ(config.tactile_modules.front().link.X_JointFrame.p_AB, Vector3(0.05, 0, 0));
  EXPECT_EQ(config.tactile_modules.front().length_m, 0.4);
}

TEST(UrdfLoad, PlacesACoverBehindAFixedJointOfTheChain) {
  SceneFiles files;
  files.robot = test::replaced(files.robot, "link: cover", "link: bend");
  const AttachedFrame link = files.load().controller.tactile_modules.front().link;
  EXPECT_EQ(link.joint, 1);
  EXPECT_EQ(link.X_JointFrame.p_AB, Vector3(0.5, 0, 0));
  EXPECT_NEAR(link.X_JointFrame.R_AB(2, 1), 1.0, kTolerance);
}

TEST(UrdfLoad, TurnsByRollPitchYawAboutFixedAxes) {
  SceneFiles files;
  files.urdf = test::replaced(files.urdf, "rpy=\"0 0 0\"", "rpy=\"0.3 -0.4 1.2\"");
  const ChainPose pose = poseAt(files.load().controller, Vector3::Zero());
  const auto turn = [](double angle, int axis) {
    return Eigen::AngleAxisd(angle, Vector3::Unit(axis)).toRotationMatrix();
  };
  const Matrix3 expected = turn(1.2, 2) * turn(-0.4, 1) * turn(0.3, 0);
  EXPECT_NEAR((pose.R_BaseJoint[1] - expected).norm(), 0.0, kTolerance);
}

TEST(UrdfLoad, AContinuousJointHasNoPositionLimits) {
  SceneFiles files;
  files.urdf = test::replaced(files.urdf, "<limit velocity=\"2\"/>",
                              "<limit velocity=\"2\" lower=\"-1\" upper=\"1\"/>");
  const JointLimits limits = files.load({{"start", "[0, 0, 100]"}}).controller.limits;
  EXPECT_EQ(limits.lower[2], -kNoLimit);
  EXPECT_EQ(limits.upper[2], kNoLimit);
}

TEST(UrdfLoad, IgnoresEverythingBesideTheChain) {
  SceneFiles files;
  files.urdf = test::replaced(
      files.urdf, "<joint name=\"grip\" type=\"clutch\">",
      "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material><!-- a comment -->"
      "<transmission name=\"t\"><joint name=\"lift\"/></transmission>"
      "<joint name=\"grip\" type=\"revolute\"><axis xyz=\"0 0 0\"/><origin xyz=\"nan\"/>");
  EXPECT_EQ(files.load().joint_names.size(), 3u);
}

TEST(UrdfLoad, IgnoresWhatLiesBeyondTheTip) {
  SceneFiles files;
  files.robot = "urdf: robot.urdf\ntip: link2\nhome: [0, 0]\n";
  files.scene =
      "robot: robot.yaml\ntask: {components: [x], trajectory: {hold: {}}}\n"
      "simulation: {duration_s: 1}\n";
  files.urdf = test::replaced(files.urdf, "name=\"roll\" type=\"continuous\"",
                              "name=\"roll\" type=\"floating\"");
  EXPECT_EQ(files.load().joint_names, (std::vector<std::string>{"lift", "shoulder"}));
}

}  // namespace
}  // namespace tactus
