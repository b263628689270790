#include "tactus/sim/link_contacts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/allocation_guard.h"
#include "support/closed_loop.h"
#include "support/random.h"
#include "support/random_robot.h"

namespace tactus {
namespace {

using test::Random;

constexpr double kContact_N_per_m = 2000.0;
constexpr double kLinkRadius_m = 0.05;

/// Joint 5 of crops9 moves a link of 0.12 m along x.
LinkCapsule fifthLink() { return {{4, {}}, Vector3::Zero(), {0.12, 0, 0}, kLinkRadius_m}; }

ChainPose poseOf(const SerialChain& chain, const JointVector& q) {
  ChainPose pose;
  chain.computePose(q, pose);
  return pose;
}

/// A sphere beside the middle of that link at the start, so deep in it.
ObstacleConfig besideFifthLink(double depth_m) {
  const ControllerConfig config = test::crops9Controller();
  const ChainPose pose = poseOf(config.chain, config.q_start);
  const Pose X_BaseLink = framePose(pose, {4, {}});
  ObstacleConfig obstacle;
  obstacle.stiffness_N_per_m = kContact_N_per_m;
  const Vector3 p_LinkCenter(0.06, 0.07 - depth_m, 0.0);
  obstacle.sphere = SphereConfig{X_BaseLink.p_AB + X_BaseLink.R_AB * p_LinkCenter, 0.02};
  return obstacle;
}

PlantConfig plantWith(const ObstacleConfig& obstacle) {
  PlantConfig plant = test::crops9Plant({obstacle});
  plant.robot_stiffness_N_per_m = kNoLimit;
  plant.capsules = {fifthLink()};
  return plant;
}

TEST(LinkContacts, PushWhereNoModuleFeelsIt) {
  const ControllerConfig config = test::crops9Controller(Variant::kNone);
  SimulatedRobot robot(config, plantWith(besideFifthLink(0.01)), 0.001);
  for (int i = 0; i < 20; ++i) robot.write(JointVector::Zero(9));
  ASSERT_NE(robot.linkContacts(), nullptr);
  EXPECT_NEAR(robot.linkContacts()->force_N(0, 0), 0.01 * kContact_N_per_m, 1e-9);
  EXPECT_NEAR(robot.linkContacts()->largest().force_N, 0.01 * kContact_N_per_m, 1e-9);
  EXPECT_EQ(robot.trueForce_N(), 0.0);
  RobotInput input;
  robot.read(input);
  EXPECT_EQ(input.tactile[0].force_y_N, 0.0);
  EXPECT_EQ(input.q_measured, config.q_start) << "a quasi-static arm does not give way";
}

TEST(LinkContacts, RememberTheStrongestAndWhen) {
  const ControllerConfig config = test::crops9Controller(Variant::kNone);
  ObstacleConfig obstacle = besideFifthLink(0.01);
  obstacle.appears_s = 0.2;
  obstacle.vanishes_s = 0.3;
  PlantConfig plant = plantWith(obstacle);
  obstacle.stiffness_N_per_m = 3000.0;
  obstacle.appears_s = 0.4;
  obstacle.vanishes_s = kNoLimit;
  plant.obstacles.push_back(obstacle);
  plant.capsules.insert(plant.capsules.begin(), {{-1, {}}, Vector3::Zero(), {0, 0, 0.1}, 0.01});
  SimulatedRobot robot(config, plant, 0.001);
  auto runUntil = [&, cycle = 0](int end) mutable {
    for (; cycle < end; ++cycle) robot.write(JointVector::Zero(9));
    return robot.linkContacts()->largest();
  };
  EXPECT_EQ(runUntil(150).force_N, 0.0);
  const UnsensedContact first = runUntil(350);
  EXPECT_NEAR(first.force_N, 20.0, 1e-9);
  EXPECT_EQ(first.capsule, 1);
  EXPECT_EQ(first.obstacle, 0);
  EXPECT_NEAR(first.t_s, 0.2, 1e-3);
  EXPECT_EQ(robot.linkContacts()->force_N(1, 0), 0.0);
  const UnsensedContact second = runUntil(500);
  EXPECT_NEAR(second.force_N, 30.0, 1e-9);
  EXPECT_EQ(second.obstacle, 1);
  EXPECT_NEAR(second.t_s, 0.4, 1e-3);
  robot.restartTime();
  EXPECT_EQ(robot.linkContacts()->largest().force_N, 0.0);
}

TEST(LinkContacts, ChangeNothingWhereNothingTouches) {
  const ControllerConfig config = test::crops9Controller(Variant::kNullTask);
  PlantConfig plant = test::crops9Plant(test::scenario1());
  test::ClosedLoop without(config, plant, 0.001);
  EXPECT_EQ(without.robot().linkContacts(), nullptr);
  plant.capsules = {{{0, {}}, Vector3::Zero(), {0.05, 0, 0}, 0.01}};
  test::ClosedLoop with(config, plant, 0.001);
  for (double t_s = 0.5; t_s < 9.0; t_s += 0.5) {
    without.runUntil(t_s);
    with.runUntil(t_s);
    ASSERT_EQ(with.input().q_measured, without.input().q_measured);
    ASSERT_EQ(with.input().tactile[0].force_y_N, without.input().tactile[0].force_y_N);
  }
  EXPECT_EQ(with.robot().linkContacts()->largest().force_N, 0.0);
}

/// A vertical line that the cover of an upright link does not meet pushes on a capsule.
TEST(LinkContacts, MeetVerticalLinesFromAllSides) {
  PlantConfig plant = test::crops9Plant({test::band(0.04, 0.0, 1000.0)});
  plant.robot_stiffness_N_per_m = kNoLimit;
  plant.capsules = {{{-1, {}}, Vector3::Zero(), {0, 0, 0.5}, kLinkRadius_m}};
  const SerialChain chain = test::crops9Chain();
  const ChainPose pose = poseOf(chain, JointVector::Zero(9));
  LinkContacts links(plant, pose);
  ScaledVector torque = ScaledVector::Zero();
  links.touch(chain, pose, 0.0, torque);
  EXPECT_NEAR(links.force_N(0, 0), 10.0, 1e-9);
  EXPECT_TRUE(torque.isZero(0.0)) << "the base does not move";
}

/// Of frictionless contact: the torques are the slope of the springs' energy over the joints.
TEST(LinkContacts, PushJointsDownTheSlopeOfAnEnergy) {
  Random random(931);
  int touched = 0;
  for (int i = 0; i < 1500; ++i) {
    const int joints = random.integer(2, 9);
    const SerialChain chain = test::randomChain(random, joints);
    const JointVector q = random.vector(joints, -1.0, 1.0);
    const ChainPose pose = poseOf(chain, q);
    PlantConfig plant;
    plant.capsules = {
        {{random.index(joints), {random.rotation(), random.vector<Vector3>(3, -0.1, 0.1)}},
         random.vector<Vector3>(3, -0.1, 0.1),
         random.vector<Vector3>(3, -0.3, 0.3),
         random.uniform(0.02, 0.1)}};
    ObstacleConfig obstacle;
    obstacle.stiffness_N_per_m = kContact_N_per_m;
    const Vector3 near =
        pointInBase(pose, plant.capsules[0].link.joint, random.vector<Vector3>(3, -0.2, 0.2));
    if (i % 3 == 0) obstacle.sphere = SphereConfig{near, 0.05};
    if (i % 3 == 1) obstacle.plane = PlaneConfig{near, random.unitVector()};
    if (i % 3 == 2) obstacle.post = PostConfig{near, random.unitVector(), 0.3, 0.02};
    plant.obstacles = {obstacle};
    const auto touchAt = [&](const JointVector& at, ScaledVector& torque) {
      const ChainPose there = poseOf(chain, at);
      LinkContacts links(plant, there);
      torque.setZero();
      links.touch(chain, there, 0.0, torque);
      return links.force_N(0, 0);
    };
    ScaledVector torque, other;
    if (touchAt(q, torque) < 1.0) continue;
    ++touched;
    for (int joint = 0; joint < joints; ++joint) {
      constexpr double kStep = 1e-6;
      const auto energy_J = [&](double step) {
        JointVector at = q;
        at[joint] += step;
        const double force_N = touchAt(at, other);
        return 0.5 * force_N * force_N / kContact_N_per_m;
      };
      ASSERT_NEAR(torque[joint], -(energy_J(kStep) - energy_J(-kStep)) / (2.0 * kStep),
                  2e-3 + 1e-4 * std::abs(torque[joint]))
          << i << ", joint " << joint;
    }
  }
  EXPECT_GT(touched, 300);
}

/// Rails along x and y; what the arm carries is pushed away along y.
TEST(LinkContacts, MoveAnArmThatHasMass) {
  Joint x;
  x.type = JointType::kPrismatic;
  x.axis = Vector3::UnitX();
  Joint y = x;
  y.axis = Vector3::UnitY();
  ControllerConfig config{.chain = SerialChain({x, y}, {1, {}})};
  config.q_start = JointVector::Zero(2);
  config.limits = test::noLimits(2);
  PlantConfig plant;
  plant.dynamics.emplace();
  plant.dynamics->bodies = {BodyInertia{1.0}, BodyInertia{5.0}};
  plant.dynamics->rotor_inertia = JointVector::Zero(2);
  plant.dynamics->gear_stiffness = JointVector::Constant(2, kNoLimit);
  plant.dynamics->gear_damping = JointVector::Zero(2);
  plant.capsules = {{{1, {}}, Vector3::Zero(), {0.2, 0, 0}, kLinkRadius_m}};
  ObstacleConfig wall;
  wall.stiffness_N_per_m = kContact_N_per_m;
  wall.plane = PlaneConfig{{0, -0.04, 0}, Vector3::UnitY()};
  plant.obstacles = {wall};
  SimulatedRobot robot(config, plant, 0.001);
  for (int i = 0; i < 4000; ++i) robot.write(JointVector::Zero(2));
  RobotInput input;
  robot.read(input);
  EXPECT_EQ(input.q_measured[0], 0.0);
  EXPECT_GT(input.q_measured[1], 1e-5);
  EXPECT_LT(robot.linkContacts()->force_N(0, 0), 20.0) << "it gave way";
  EXPECT_NEAR(robot.linkContacts()->force_N(0, 0), kContact_N_per_m * (0.01 - input.q_measured[1]),
              1e-6);
}

TEST(LinkContacts, UseNoHeapAfterConstruction) {
  const ControllerConfig config = test::crops9Controller(Variant::kNullTask);
  PlantConfig plant = plantWith(besideFifthLink(0.01));
  for (int kind = 0; kind < 4; ++kind) {
    ObstacleConfig obstacle = test::band(0.55, -0.15, 500.0);
    if (kind == 1) obstacle.plane = PlaneConfig{{0.6, 0, 0}, {-1, 0, 0}};
    if (kind == 2) obstacle.line = LineConfig{{0.6, 0, 0.8}, {0, 1, 0}};
    if (kind == 3) obstacle.post = PostConfig{{0.6, 0, 0.5}, {0, 0, 1}, 0.3, 0.02};
    obstacle.friction_coefficient = 0.3;
    obstacle.swing = {0.01, 0.01, 2.0, 0.01};
    plant.obstacles.push_back(obstacle);
  }
  test::ClosedLoop loop(config, plant, 0.001);
  for (int i = 0; i < 2000; ++i) {
    test::AllocationGuard guard;
    loop.step();
  }
  EXPECT_GT(loop.robot().linkContacts()->largest().force_N, 1.0);
}

TEST(SimulatedRobot, HasLinksOfItsOwnLength) {
  const ControllerConfig config = test::crops9Controller();
  PlantConfig plant = test::crops9Plant({});
  std::vector<Joint> joints(2);
  joints[1].X_ParentJoint.p_AB = Vector3(0.3, 0, 0);
  ControllerConfig planar{.chain = SerialChain(joints, {1, {Matrix3::Identity(), {0.2, 0, 0}}})};
  planar.q_start = JointVector::Zero(2);
  planar.limits = test::noLimits(2);
  joints[1].X_ParentJoint.p_AB.x() = 0.31;
  plant.chain = SerialChain(joints, {1, {Matrix3::Identity(), {0.2, 0, 0}}});
  EXPECT_NEAR(SimulatedRobot(planar, plant, 0.001).toolPosition().x(), 0.51, 1e-15);
  plant.chain.reset();
  EXPECT_NEAR(SimulatedRobot(planar, plant, 0.001).toolPosition().x(), 0.5, 1e-15);
}

}  // namespace
}  // namespace tactus
