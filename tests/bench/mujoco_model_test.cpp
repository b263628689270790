#include "tactus/bench/mujoco_model.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/random_robot.h"
#include "support/shipped_scene.h"
#include "tactus/bench/mujoco_robot.h"

namespace tactus::physics {
namespace {

constexpr double kRigid = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-6;  ///< MuJoCo turns inertias into their principal axes as exactly

/// That of a cloud of points, which every body has.
BodyInertia randomCloud(test::Random& random) {
  BodyInertia body{random.logUniform(0.1, 20.0), random.vector<Vector3>(3, -0.3, 0.3), {}};
  body.I_Com.setZero();
  for (int i = 0; i < 5; ++i) {
    const Vector3 p = random.vector<Vector3>(3, -0.2, 0.2);
    body.I_Com += 0.2 * body.mass_kg * (p.squaredNorm() * Matrix3::Identity() - p * p.transpose());
  }
  return body;
}

struct RandomArm {
  RandomArm(test::Random& random, double gear_stiffness)
      : robot{.chain = test::randomChain(random, random.integer(2, kMaxJoints))} {
    const int n = robot.chain.size();
    robot.q_start = random.vector(n, -3.0, 3.0);
    robot.limits = test::noLimits(n);
    ArmDynamicsConfig dynamics;
    for (int i = 0; i < n; ++i) dynamics.bodies.push_back(randomCloud(random));
    dynamics.rotor_inertia = random.vector(n, 0.0, 2.0);
    dynamics.gear_stiffness = JointVector::Constant(n, gear_stiffness);
    dynamics.gear_damping = JointVector::Ones(n);
    plant.dynamics = dynamics;
  }

  ControllerConfig robot;
  PlantConfig plant;
};

TEST(MujocoModel, HasTheMassMatrixAndTheToolOfRandomArms) {
  test::Random random(711);
  for (int run = 0; run < 200; ++run) {
    const RandomArm arm(random, kRigid);
    const MujocoRobot mujoco(arm.robot, arm.plant, 0.001);
    MassMatrix M = massMatrixAt(arm.robot.chain, arm.plant.dynamics->bodies, arm.robot.q_start);
    M.diagonal() += arm.plant.dynamics->rotor_inertia;
    ASSERT_LT((mujoco.massMatrix() - M).cwiseAbs().maxCoeff(), kTolerance * M.cwiseAbs().maxCoeff())
        << run;
    const Vector3 p = tipPose(arm.robot.chain, arm.robot.q_start).p_AB;
    ASSERT_LT((mujoco.toolPosition() - p).norm(), 1e-11) << run;
  }
}

/// Behind a gear a motor moves its rotor, and the link with it: sum and parts of both.
TEST(MujocoModel, PutsRotorsBehindFlexibleGears) {
  test::Random random(712);
  for (int run = 0; run < 50; ++run) {
    const RandomArm arm(random, 1e4);
    const Eigen::MatrixXd all = MujocoRobot(arm.robot, arm.plant, 0.001).massMatrix();
    const MassMatrix M =
        massMatrixAt(arm.robot.chain, arm.plant.dynamics->bodies, arm.robot.q_start);
    for (int i = 0; i < M.rows(); ++i) {
      for (int j = 0; j < M.rows(); ++j) {
        const double rotor = i == j ? arm.plant.dynamics->rotor_inertia[i] : 0.0;
        const double tolerance = kTolerance * M.cwiseAbs().maxCoeff();
        ASSERT_NEAR(all(2 * i, 2 * j), M(i, j) + rotor, tolerance);
        ASSERT_NEAR(all(2 * i + 1, 2 * j + 1), M(i, j), tolerance);
        ASSERT_NEAR(all(2 * i, 2 * j + 1), M(i, j), tolerance);
      }
    }
  }
}

TEST(MujocoModel, HasTheMassMatrixOfTheShippedArmAnywhere) {
  const Scene scene = test::shippedScene("free_motion", {{"simulation.arm", "rigid_gears"}});
  test::Random random(713);
  for (int run = 0; run < 50; ++run) {
    ControllerConfig robot = scene.controller;
    for (int i = 0; i < robot.chain.size(); ++i)
      robot.q_start[i] = random.uniform(robot.limits.lower[i], robot.limits.upper[i]);
    const MujocoRobot mujoco(robot, scene.plant, 0.001);
    MassMatrix M = massMatrixAt(robot.chain, scene.plant.dynamics->bodies, robot.q_start);
    M.diagonal() += scene.plant.dynamics->rotor_inertia;
    ASSERT_LT((mujoco.massMatrix() - M).cwiseAbs().maxCoeff(),
              kTolerance * M.cwiseAbs().maxCoeff());
  }
}

TEST(MujocoModel, SaysWhatMujocoDoesNotTake) {
  EXPECT_THROW(loadMujoco("<mujoco><nothing/></mujoco>"), std::runtime_error);
  Scene scene = test::shippedScene("scenario1_none");
  EXPECT_THROW(MujocoRobot(scene.controller, scene.plant, 0.001), std::invalid_argument);
  scene = test::shippedScene("scenario1_none", {{"simulation.arm", "rigid_gears"}});
  EXPECT_THROW(MujocoRobot(scene.controller, scene.plant, 0.001, 0.0007), std::invalid_argument);
  scene.plant.obstacles[0].vanishes_s = 3.0;
  EXPECT_THROW(MujocoRobot(scene.controller, scene.plant, 0.001), std::invalid_argument);
}

}  // namespace
}  // namespace tactus::physics
