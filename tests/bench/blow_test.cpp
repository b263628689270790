#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "support/shipped_scene.h"
#include "tactus/bench/mujoco_robot.h"
#include "tactus/sim/simulated_robot.h"

/// The forearm is driven against a post without anything that gives way.
namespace tactus::physics {
namespace {

struct Blow {
  std::string arm;
  double robot_stiffness_N_per_m;  ///< of the arm at the contact
  double stiffness_N_per_m;
  double friction_coefficient;
};

void PrintTo(const Blow& blow, std::ostream* stream) {
  *stream << blow.arm << ", " << blow.stiffness_N_per_m << " N/m, mu " << blow.friction_coefficient;
}

struct Pressed {
  double peak_N = 0.0, end_N = 0.0;
  Vector3 felt = Vector3::Zero();  ///< by the module at the end: F_y, F_z in N, M_z in Nm
};

/// Joint 2 turns the arm onto the post and stops; later joint 1 lifts the cover along it.
template <typename SomeRobot>
Pressed press(SomeRobot& robot, double speed) {
  Pressed pressed;
  RobotInput input;
  for (int cycle = 0; cycle < 500; ++cycle) {
    JointVector v = JointVector::Zero(9);
    if (cycle < 60) v[1] = speed;
    if (cycle >= 300) v[0] = 0.05;
    robot.write(v);
    robot.read(input);
    pressed.peak_N = std::max(pressed.peak_N, robot.trueForce_N());
  }
  pressed.end_N = robot.trueForce_N();
  const TactileSample& sample = input.tactile[0];
  pressed.felt = Vector3(sample.force_y_N, sample.force_z_N, sample.moment_z_Nm);
  return pressed;
}

/// The cover before joint 2 turns it.
struct CoverPlace {
  Vector3 middle, aside;  ///< m; level, where it will go
  double gap_m;           ///< from the middle to what it will just not touch
};

CoverPlace coverPlace(const Scene& scene) {
  const TactileModuleConfig& module = scene.controller.tactile_modules.front();
  ChainPose pose;
  scene.controller.chain.computePose(scene.controller.q_start, pose);
  const Pose X = framePose(pose, module.link);
  const Vector3 along = X.R_AB.col(0);
  return {X.p_AB + 0.5 * module.length_m * along, Vector3(-along.y(), along.x(), 0.0).normalized(),
          scene.plant.modules[0].cover_radius_m + 0.001};
}

void placePost(const Scene& scene, ObstacleConfig& post) {
  const auto& [middle, aside, gap_m] = coverPlace(scene);
  const Vector3 place = middle + gap_m * aside;
  post.x_m = place.x();
  post.y_m = place.y();
}

/// A blow of about 200 N at most, in both plants.
void expectTheSame(const Scene& scene, const Blow& blow) {
  const double speed = std::clamp(200.0 / blow.stiffness_N_per_m, 0.05, 0.3);
  SimulatedRobot built_in(scene.controller, scene.plant, 0.001);
  MujocoRobot mujoco(scene.controller, scene.plant, 0.001, 0.0001);
  const Pressed expected = press(mujoco, speed);
  const Pressed pressed = press(built_in, speed);
  ASSERT_TRUE(mujoco.isSound());
  ASSERT_GT(expected.peak_N, 1.0) << "nothing was hit";
  EXPECT_NEAR(pressed.peak_N, expected.peak_N, 0.02 * expected.peak_N);
  EXPECT_NEAR(pressed.end_N, expected.end_N, 0.02 * expected.peak_N);
  EXPECT_LT((pressed.felt - expected.felt).norm(), 0.02 * expected.peak_N);
}

class BlowOnAPost : public testing::TestWithParam<Blow> {};

TEST_P(BlowOnAPost, IsAsHardInMujoco) {
  const Blow& blow = GetParam();
  Scene scene = test::shippedScene("scenario1_none", {{"simulation.arm", blow.arm}});
  scene.plant.robot_stiffness_N_per_m = blow.robot_stiffness_N_per_m;
  ObstacleConfig& post = scene.plant.obstacles[0];
  placePost(scene, post);
  post.stiffness_N_per_m = blow.stiffness_N_per_m;
  post.friction_coefficient = blow.friction_coefficient;
  expectTheSame(scene, blow);
}

/// A ball beside the middle of the cover, a little above it, or a tilted wall there.
void placeShape(const Scene& scene, bool is_wall, ObstacleConfig& obstacle) {
  const auto& [middle, aside, gap_m] = coverPlace(scene);
  const Vector3 there = aside + Vector3(0.0, 0.0, 0.3);
  if (is_wall) {
    obstacle.plane = PlaneConfig{middle + gap_m * there, Vector3(0.3, -1.0, 0.4)};
  } else {
    obstacle.sphere = SphereConfig{middle + (gap_m + 0.05) * there.normalized(), 0.05};
  }
}

class BlowOnAShape : public testing::TestWithParam<std::tuple<bool, Blow>> {};

TEST_P(BlowOnAShape, IsAsHardInMujoco) {
  const auto& [is_wall, blow] = GetParam();
  Scene scene = test::shippedScene("scenario1_none", {{"simulation.arm", blow.arm}});
  scene.plant.robot_stiffness_N_per_m = blow.robot_stiffness_N_per_m;
  ObstacleConfig& obstacle = scene.plant.obstacles[0];
  obstacle.stiffness_N_per_m = blow.stiffness_N_per_m;
  placeShape(scene, is_wall, obstacle);
  expectTheSame(scene, blow);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, BlowOnAShape,
    testing::Combine(testing::Bool(), testing::Values(Blow{"rigid_gears", 7000.0, 1e3, 0.0},
                                                      Blow{"rigid_gears", kNoLimit, 1e5, 0.0},
                                                      Blow{"flexible_gears", 48000.0, 1e5, 0.0})));

std::vector<Blow> blows() {
  std::vector<Blow> all;
  for (const double mu : {0.0, 0.5})
    for (const double stiffness : {1e3, 1e6}) {
      all.push_back({"rigid_gears", 7000.0, stiffness, mu});
      all.push_back({"rigid_gears", kNoLimit, stiffness, mu});
      all.push_back({"flexible_gears", 48000.0, stiffness, mu});
    }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Posts, BlowOnAPost, testing::ValuesIn(blows()));

}  // namespace
}  // namespace tactus::physics
