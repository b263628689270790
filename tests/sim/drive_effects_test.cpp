#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/random_robot.h"
#include "tactus/sim/arm_dynamics.h"

/// Torque limits, friction and backlash of arms with mass.
namespace tactus {
namespace {

constexpr double kStiffGear = std::numeric_limits<double>::infinity();

/// Two carriages on one rail: the masses move along the same axis, so the mass matrix is constant
/// and couples both joints.
struct CoupledRails {
  CoupledRails() : chain(joints(), {1, {}}) {
    config.bodies = {BodyInertia{3.0}, BodyInertia{2.0}};
    config.rotor_inertia = JointVector::Constant(2, 0.5);
    config.gear_stiffness = JointVector::Constant(2, kStiffGear);
    config.gear_damping = JointVector::Zero(2);
  }

  static std::vector<Joint> joints() {
    Joint y;
    y.type = JointType::kPrismatic;
    y.axis = Vector3::UnitY();
    return {y, y};
  }

  void start() { arm.emplace(chain, config, JointVector::Zero(2)); }

  void step(const JointVector& velocity, const JointVector& force_N) {
    ChainPose pose;
    chain.computePose(arm->q(), pose);
    q_desired += config.step_s * velocity;
    const JointVector links = arm->q(), motors = arm->qMotor();
    arm->step(config.step_s, q_desired, velocity, force_N, pose);
    v_before = v;
    v_motor_before = v_motor;
    v = (arm->q() - links) / config.step_s;
    v_motor = (arm->qMotor() - motors) / config.step_s;
  }

  Eigen::Matrix2d masses() const {
    const double outer = config.bodies[1].mass_kg;
    return (Eigen::Matrix2d() << config.bodies[0].mass_kg + outer, outer, outer, outer).finished();
  }

  /// What pushed on the joints in the last step beside force_N: servos and friction.
  Eigen::Vector2d pushOfDrives(const JointVector& force_N) const {
    Eigen::Matrix2d M = masses();
    M.diagonal() += config.rotor_inertia;
    return M * (v - v_before) / config.step_s - force_N;
  }

  /// Of motion and gears.
  double energy() const {
    double result = 0.5 * v.dot(masses() * v);
    for (int i = 0; i < 2; ++i) {
      result += 0.5 * config.rotor_inertia[i] * v_motor[i] * v_motor[i];
      if (std::isinf(config.gear_stiffness[i])) continue;
      const double play = config.backlash.size() > 0 ? 0.5 * config.backlash[i] : 0.0;
      const double stretch = std::max(0.0, std::abs(arm->qMotor()[i] - arm->q()[i]) - play);
      result += 0.5 * config.gear_stiffness[i] * stretch * stretch;
    }
    return result;
  }

  SerialChain chain;
  ArmDynamicsConfig config;
  std::optional<ArmDynamics> arm;
  JointVector q_desired = JointVector::Zero(2);
  JointVector v = JointVector::Zero(2), v_before = v, v_motor = v, v_motor_before = v;
};

JointVector both(double a, double b) { return Eigen::Vector2d(a, b); }

TEST(DriveEffects, ServosNeverPushMoreThanTheirLimit) {
  test::Random random(941);
  for (int run = 0; run < 40; ++run) {
    CoupledRails rails;
    rails.config.max_torque = both(random.logUniform(0.1, 50.0), random.logUniform(0.1, 50.0));
    if (random.chance(0.3)) rails.config.servo_integral_hz = 0.0;
    rails.start();
    bool was_limited = false;
    JointVector velocity = both(0.0, 0.0), force_N = velocity;
    for (int i = 0; i < 4000; ++i) {
      if (i % 300 == 0) velocity = random.vector(2, -1.0, 1.0);
      if (i % 70 == 0) force_N = random.vector(2, -20.0, 20.0);
      rails.step(velocity, force_N);
      const Eigen::Vector2d push = rails.pushOfDrives(force_N);
      for (int k = 0; k < 2; ++k) {
        ASSERT_LE(std::abs(push[k]), rails.config.max_torque[k] * (1.0 + 1e-6) + 1e-6) << i;
        was_limited |= std::abs(push[k]) > 0.999 * rails.config.max_torque[k];
      }
    }
    EXPECT_TRUE(was_limited || rails.config.max_torque.minCoeff() > 20.0);
  }
}

/// With a limit that is out of reach all is as without one.
TEST(DriveEffects, ALimitOutOfReachChangesNothing) {
  CoupledRails plain, limited;
  limited.config.max_torque = both(1e9, 1e9);
  plain.start();
  limited.start();
  for (int i = 0; i < 2000; ++i) {
    const JointVector velocity = both(std::sin(0.01 * i), std::cos(0.013 * i));
    plain.step(velocity, both(1.0, -2.0));
    limited.step(velocity, both(1.0, -2.0));
    ASSERT_EQ(plain.arm->q(), limited.arm->q());
  }
}

/// m v' = F - tau_c while it slides; and what is pushed with less than tau_c stays where it is.
TEST(DriveEffects, FrictionBrakesWithItsTorqueAndHoldsBelowIt) {
  CoupledRails rails;
  rails.config.max_torque = both(1e-9, 1e-9);  // only friction is left of the drives
  rails.config.coulomb_friction = both(4.0, 1e6);
  rails.start();
  const double mass_kg = 3.0 + 2.0 + 0.5;  // the outer joint is held
  for (int i = 0; i < 8000; ++i) rails.step(both(0.0, 0.0), both(3.9, 0.0));
  EXPECT_LT(std::abs(rails.arm->q()[0]), 1.1e-5) << "it creeps by no more than the sticking speed";
  for (int i = 0; i < 800; ++i) rails.step(both(0.0, 0.0), both(15.0, 0.0));
  EXPECT_NEAR(rails.v[0], 0.1 * 11.0 / mass_kg, 1e-4);
  const double v_0 = rails.v[0];
  int steps = 0;
  while (rails.v[0] > 1e-4 && ++steps < 100000) rails.step(both(0.0, 0.0), both(0.0, 0.0));
  EXPECT_NEAR(steps * rails.config.step_s, v_0 * mass_kg / 4.0, 2e-3);
  const double at_rest = rails.arm->q()[0];
  for (int i = 0; i < 8000; ++i) rails.step(both(0.0, 0.0), both(0.0, 0.0));
  EXPECT_NEAR(rails.arm->q()[0], at_rest, 1e-5);
}

TEST(DriveEffects, ViscousFrictionSlowsDownExponentially) {
  CoupledRails rails;
  rails.config.max_torque = both(1e-9, 1e-9);
  rails.config.coulomb_friction = both(0.0, 1e6);
  rails.config.viscous_friction = both(11.0, 0.0);
  rails.start();
  for (int i = 0; i < 400; ++i) rails.step(both(0.0, 0.0), both(30.0, 0.0));
  const double v_0 = rails.v[0];
  for (int i = 0; i < 4000; ++i) rails.step(both(0.0, 0.0), both(0.0, 0.0));
  EXPECT_NEAR(rails.v[0], v_0 * std::exp(-11.0 / 5.5 * 0.5), 1e-3 * v_0);
}

/// Whatever gears, play and friction there are: left alone, energy only falls.
TEST(DriveEffects, NothingOfItMakesEnergy) {
  test::Random random(942);
  for (int run = 0; run < 60; ++run) {
    CoupledRails rails;
    rails.config.rotor_inertia = both(random.logUniform(0.05, 5.0), random.logUniform(0.05, 5.0));
    if (random.chance(0.8))
      rails.config.gear_stiffness = both(random.logUniform(1e2, 1e6), random.logUniform(1e2, 1e6));
    rails.config.gear_damping = both(random.logUniform(1e-2, 1e3), random.logUniform(1e-2, 1e3));
    rails.config.max_torque = both(1e-12, 1e-12);
    if (random.chance(0.7)) rails.config.coulomb_friction = random.vector(2, 0.0, 5.0);
    if (random.chance(0.7)) rails.config.viscous_friction = random.vector(2, 0.0, 5.0);
    if (random.chance(0.7)) rails.config.backlash = random.vector(2, 0.0, 5e-3);
    rails.start();
    for (int i = 0; i < 300; ++i) rails.step(both(0.0, 0.0), random.vector(2, -100.0, 100.0));
    double before = rails.energy();
    const double first = before;
    ASSERT_GT(first, 0.0);
    for (int i = 0; i < 8000; ++i) {
      rails.step(both(0.0, 0.0), both(0.0, 0.0));
      ASSERT_LE(rails.energy(), before + 1e-9 * first + 1e-12) << run << " " << i;
      before = rails.energy();
    }
  }
}

/// A slow motor to and fro, far slower than anything rings: the link stays while the motor crosses
/// the play, and follows it with half of the play in between.
TEST(DriveEffects, BacklashIsAHysteresisOfItsWidth) {
  CoupledRails rails;
  rails.config.gear_stiffness.setConstant(1e6);
  rails.config.gear_damping.setConstant(2e3);
  rails.config.backlash = both(2e-3, 0.0);
  rails.config.bodies[0].mass_kg = 0.1;
  rails.config.bodies[1].mass_kg = 0.1;
  rails.start();
  const auto drag = [&] { return both(-200.0 * rails.v[0], 0.0); };  // so that links do not fly on
  const auto move = [&](double speed, double duration_s) {
    for (int i = 0; i < duration_s / rails.config.step_s; ++i) rails.step(both(speed, 0.0), drag());
  };
  move(0.01, 1.0);
  EXPECT_NEAR(rails.arm->qMotor()[0] - rails.arm->q()[0], 1e-3, 1e-5);
  const double turned = rails.arm->q()[0];
  move(-0.01, 0.1);  // 1 mm back: amid the play
  EXPECT_NEAR(rails.arm->q()[0], turned, 3e-5);
  move(-0.01, 0.9);
  EXPECT_NEAR(rails.arm->qMotor()[0] - rails.arm->q()[0], -1e-3, 1e-5);
  EXPECT_LT(std::abs(rails.arm->qMotor()[0]), 3e-4) << "the drag stretches its servo";
}

TEST(DriveEffects, AreRefusedWithoutOneEntryAJointOrPlayWithoutARotor) {
  CoupledRails rails;
  rails.config.max_torque = JointVector::Ones(3);
  EXPECT_THROW(rails.start(), std::invalid_argument);
  rails.config.max_torque = {};
  rails.config.rotor_inertia.setZero();
  rails.config.backlash = both(0.0, 1e-3);
  EXPECT_THROW(rails.start(), std::invalid_argument);
}

}  // namespace
}  // namespace tactus
