#include "tactus/sim/arm_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/random_robot.h"

namespace tactus {
namespace {

constexpr double kRigid = std::numeric_limits<double>::infinity();
constexpr double kMass_kg = 5.0;

/// Two rails, the second of which carries kMass_kg, along y.
struct Rails {
  Rails() : chain(joints(), {1, {}}) {
    config.bodies = {BodyInertia{1.0}, BodyInertia{kMass_kg}};
    config.rotor_inertia = JointVector::Zero(2);
    config.gear_stiffness = JointVector::Constant(2, kRigid);
    config.gear_damping = JointVector::Zero(2);
  }

  static std::vector<Joint> joints() {
    Joint x;
    x.type = JointType::kPrismatic;
    x.axis = Vector3::UnitX();
    Joint y = x;
    y.axis = Vector3::UnitY();
    return {x, y};
  }

  void step(ArmDynamics& arm, double velocity, double force_N) {
    y_desired += config.step_s * velocity;
    ChainPose pose;
    chain.computePose(arm.q(), pose);
    const JointVector torque = Eigen::Vector2d(0.0, force_N);
    arm.step(config.step_s, Eigen::Vector2d(0.0, y_desired), Eigen::Vector2d(0.0, velocity), torque,
             pose);
  }

  SerialChain chain;
  ArmDynamicsConfig config;
  double y_desired = 0.0;
};

TEST(ArmDynamics, FollowsItsSetpointWithoutALastingError) {
  Rails rails;
  ArmDynamics arm(rails.chain, rails.config, JointVector::Zero(2));
  for (int i = 0; i < 8000; ++i) rails.step(arm, 0.1, 0.0);
  EXPECT_NEAR(arm.q()[1], 0.1, 1e-6);
  for (int i = 0; i < 8000; ++i) rails.step(arm, 0.0, 20.0);  // and against a force
  EXPECT_NEAR(arm.q()[1],
              0.1 + 20.0 / (kMass_kg * 4.0 * 40.0 * 8.0 * std::pow(std::numbers::pi, 2)), 1e-6)
      << "the spring of its integral part";
  EXPECT_EQ(arm.q()[0], 0.0);
}

/// With servos too weak to matter, a blow against k comes to v sqrt(k m).
TEST(ArmDynamics, HitsAsHardAsItsMass) {
  for (const double k : {1e3, 1e5, 1e6}) {
    Rails rails;
    rails.config.servo_bandwidth_hz = 1e-6;
    rails.config.servo_integral_hz = 0.0;
    rails.config.step_s = 1e-5;
    ArmDynamics arm(rails.chain, rails.config, JointVector::Zero(2));
    for (int i = 0; i < 100; ++i)
      rails.step(arm, 0.0, kMass_kg * 0.2 / (100 * rails.config.step_s));
    const double wall_m = arm.q()[1] + 1e-4;
    double peak_N = 0.0;
    for (int i = 0; i < 40000; ++i) {
      const double force_N = k * std::max(0.0, arm.q()[1] - wall_m);
      peak_N = std::max(peak_N, force_N);
      rails.step(arm, 0.0, -force_N);
    }
    EXPECT_NEAR(peak_N, 0.2 * std::sqrt(k * kMass_kg), 0.01 * peak_N) << k;
  }
}

/// A motor that is held fast, and a link behind its gear: it rings with sqrt(K / m).
TEST(ArmDynamics, RingsWithTheModeOfItsGear) {
  Rails rails;
  rails.config.rotor_inertia.setConstant(1e6);
  rails.config.gear_stiffness.setConstant(2e4);
  ArmDynamics arm(rails.chain, rails.config, JointVector::Zero(2));
  rails.step(arm, 0.0, 1000.0);
  int crossings = 0;
  double before = arm.q()[1];
  for (int i = 0; i < 16000; ++i) {
    rails.step(arm, 0.0, 0.0);
    crossings += before < 0.0 && arm.q()[1] >= 0.0;
    before = arm.q()[1];
  }
  EXPECT_NEAR(crossings / 2.0, std::sqrt(2e4 / kMass_kg) / (2.0 * std::numbers::pi), 0.5);
  EXPECT_LT(std::abs(arm.qMotor()[1]), 1e-6);
}

/// A random arm that was hit swings out, however stiff or light its parts.
TEST(ArmDynamics, NeverSwingsFurtherThanItWasHit) {
  test::Random random(611);
  for (int run = 0; run < 30; ++run) {
    const int n = random.integer(2, 9);
    const SerialChain chain(test::randomJoints(random, n), {n - 1, {}});
    ArmDynamicsConfig config;
    for (int i = 0; i < n; ++i) {
      config.bodies.push_back({random.logUniform(0.05, 20.0), random.vector<Vector3>(3, -0.2, 0.2),
                               random.logUniform(1e-4, 0.1) * Matrix3::Identity()});
    }
    config.rotor_inertia = JointVector::Constant(n, random.logUniform(1e-3, 1.0));
    config.gear_stiffness = JointVector::Constant(n, random.logUniform(1e2, 1e7));
    config.gear_damping = JointVector::Constant(n, random.logUniform(1e-3, 10.0));
    const JointVector q = random.vector(n, -1.0, 1.0);
    ArmDynamics arm(chain, config, q);
    ChainPose pose;
    const auto step = [&](const JointVector& torque) {
      chain.computePose(arm.q(), pose);
      arm.step(config.step_s, q, JointVector::Zero(n), torque, pose);
    };
    for (int i = 0; i < 80; ++i) step(random.vector(n, -5.0, 5.0));
    double early = 0.0, late = 0.0;
    for (int i = 0; i < 40000; ++i) {
      step(JointVector::Zero(n));
      double& farthest = i < 8000 ? early : late;
      if (i < 8000 || i >= 32000) farthest = std::max(farthest, (arm.q() - q).norm());
    }
    EXPECT_GT(early, 0.0);
    EXPECT_LT(late, early);
  }
}

TEST(ArmDynamics, RefusesAnArmWithoutMass) {
  Rails rails;
  rails.config.bodies[1].mass_kg = 0.0;
  EXPECT_THROW(ArmDynamics(rails.chain, rails.config, JointVector::Zero(2)), std::invalid_argument);
  rails.config.bodies.pop_back();
  EXPECT_THROW(ArmDynamics(rails.chain, rails.config, JointVector::Zero(2)), std::invalid_argument);
}

}  // namespace
}  // namespace tactus
