#include <gtest/gtest.h>

#include <cmath>

#include "support/closed_loop.h"
#include "support/random.h"
#include "tactus/sim/obstacle.h"
#include "tactus/sim/simulated_robot.h"

/// Posts that slide away on their foot.
namespace tactus {
namespace {

constexpr double kPost_N_per_m = 4000.0, kSlides_N = 2.0;
constexpr double kPostAndCover_m = 0.01 + 0.05;

ObstacleConfig slidingPost(const Vector3& foot_m) {
  ObstacleConfig config;
  config.post = PostConfig{foot_m, Vector3::UnitZ(), 1.0, 0.01};
  config.stiffness_N_per_m = kPost_N_per_m;
  config.slide_force_N = kSlides_N;
  return config;
}

CoverAxis coverAt(double y_m) { return {{-0.5, y_m, 0.5}, Vector3::UnitX(), 1.0, 0.05}; }

TEST(SlidingPost, IsASpringUpToItsForceAndThenGoesAlong) {
  Obstacle obstacle(slidingPost(Vector3::Zero()), kNoLimit);
  Vector3 slid_m = Vector3::Zero();
  const double bends_m = kSlides_N / kPost_N_per_m;
  double y_m = 0.1;
  for (; y_m > kPostAndCover_m - bends_m; y_m -= 1e-5) {
    const double depth_m = kPostAndCover_m - y_m;
    EXPECT_NEAR(obstacle.touch(coverAt(y_m), 0.0, &slid_m).force_N,
                kPost_N_per_m * std::max(0.0, depth_m), 1e-9);
  }
  EXPECT_EQ(slid_m, Vector3::Zero());
  for (; y_m > -0.3; y_m -= 1e-3) {
    EXPECT_NEAR(obstacle.touch(coverAt(y_m), 0.0, &slid_m).force_N, kSlides_N, 1e-9);
    EXPECT_NEAR(slid_m.y(), y_m + bends_m - kPostAndCover_m, 1e-9) << "as far as it was pushed";
  }
  EXPECT_NEAR(obstacle.touch(coverAt(y_m + 1e-3 + 2 * bends_m), 0.0, &slid_m).force_N, 0.0, 1e-9)
      << "it does not come back";
}

/// Through foam, too, and whichever way it is pushed; what bears more stands.
TEST(SlidingPost, NeverPushesHarderThanItBears) {
  test::Random random(77);
  int slid = 0;
  for (int i = 0; i < 200; ++i) {
    ObstacleConfig config = slidingPost(random.vector<Vector3>(3, -0.1, 0.1));
    config.post->foot_m.z() = 0.0;
    config.foam = {{random.uniform(100.0, 3000.0), random.uniform(0.5, 4.0)}};
    const double bears_N = random.uniform(0.3, 8.0);
    config.slide_force_N = bears_N;
    const double robot_N_per_m = i % 2 == 0 ? kNoLimit : 2000.0;
    Obstacle slides(config, robot_N_per_m);
    config.slide_force_N.reset();
    Obstacle stands(config, robot_N_per_m);
    Vector3 slid_m = Vector3::Zero();
    const Vector3 from = random.vector<Vector3>(3, -0.2, 0.2);
    const Vector3 way = random.vector<Vector3>(3, -0.3, 0.3);
    for (int k = 0; k <= 100; ++k) {
      CoverAxis axis = coverAt(0.0);
      axis.p_BaseStart += Vector3(from.x(), from.y(), 0.0) + 0.01 * k * way;
      const ObstacleContact contact = slides.touch(axis, 0.0, &slid_m);
      const double standing_N = stands.touch(axis, 0.0).force_N;
      ASSERT_LE(contact.force_N, bears_N);
      if (slid_m.isZero(0.0)) {
        ASSERT_EQ(contact.force_N, standing_N);
      }
    }
    slid += !slid_m.isZero(0.0);
  }
  EXPECT_GT(slid, 50);
}

/// Where one cover has pushed it, the next one finds it.
TEST(SlidingPost, IsTheSameForAllCovers) {
  ControllerConfig controller = test::crops9Controller(Variant::kNone);
  PlantConfig plant = test::crops9Plant({});
  plant.robot_stiffness_N_per_m = kNoLimit;
  controller.tactile_modules.push_back(controller.tactile_modules[0]);
  plant.modules.push_back(plant.modules[0]);
  ChainPose pose;
  controller.chain.computePose(controller.q_start, pose);
  const TactileModuleConfig& module = controller.tactile_modules[0];
  const Pose X = framePose(pose, module.link);
  const Vector3 middle = X.p_AB + 0.5 * module.length_m * X.R_AB.col(0);
  const Vector3 side = X.R_AB.col(0).cross(Vector3::UnitZ()).normalized();
  const double inside_m = 0.01;
  ObstacleConfig post = slidingPost(Vector3::Zero());
  post.post->foot_m =
      middle - 0.5 * Vector3::UnitZ() + (plant.modules[0].cover_radius_m + 0.01 - inside_m) * side;
  plant.obstacles = {post};
  SimulatedRobot robot(controller, plant, 0.001);
  robot.write(JointVector::Zero(9));
  EXPECT_NEAR(robot.trueForce_N(0), kSlides_N, 1e-9);
  EXPECT_NEAR(robot.trueForce_N(1), kSlides_N, 1e-9) << "it stands there, and is not pushed on";
  EXPECT_NEAR(robot.hardestContact_N(0), kSlides_N, 1e-9);
}

/// What pushes from two sides adds up to nothing, and still pushes.
TEST(HardestContact, IsNotHiddenByTheSumOfForces) {
  const ControllerConfig controller = test::crops9Controller(Variant::kNone);
  PlantConfig plant = test::crops9Plant({});
  plant.robot_stiffness_N_per_m = kNoLimit;
  ChainPose pose;
  controller.chain.computePose(controller.q_start, pose);
  const TactileModuleConfig& module = controller.tactile_modules[0];
  const Pose X = framePose(pose, module.link);
  const Vector3 middle = X.p_AB + 0.5 * module.length_m * X.R_AB.col(0);
  for (const double side : {-1.0, 1.0}) {
    ObstacleConfig ball;
    ball.sphere = SphereConfig{
        middle + side * (plant.modules[0].cover_radius_m + 0.01) * X.R_AB.col(1), 0.02};
    ball.stiffness_N_per_m = 500.0;
    plant.obstacles.push_back(ball);
  }
  SimulatedRobot robot(controller, plant, 0.001);
  robot.write(JointVector::Zero(9));
  EXPECT_NEAR(robot.hardestContact_N(0), 5.0, 1e-9);
  EXPECT_NEAR(robot.trueForce_N(0), 0.0, 1e-9);
}

}  // namespace
}  // namespace tactus
