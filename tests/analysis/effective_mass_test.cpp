#include "tactus/analysis/effective_mass.h"

#include <gtest/gtest.h>

#include "support/crops9.h"
#include "support/random.h"
#include "tactus/sim/arm_dynamics.h"

namespace tactus {
namespace {

using test::Random;

BodyInertia randomBody(Random& random) {
  BodyInertia body;
  body.mass_kg = random.uniform(0.5, 8.0);
  body.p_JointCom = random.vector<Vector3>(3, -0.2, 0.2);
  const Vector3 size = random.vector<Vector3>(3, 0.05, 0.4);  // of a box
  const Vector3 squares = size.cwiseProduct(size);
  body.I_Com =
      body.mass_kg / 12.0 *
      Vector3(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y())
          .asDiagonal()
          .toDenseMatrix();
  return body;
}

/// An arm whose servos do nothing, hit by a force for one step.
double massThatAHammerFinds(const SerialChain& chain, const ArmDynamicsConfig& config,
                            const JointVector& q, int joint, const Vector3& p, const Vector3& n) {
  constexpr double kStep_s = 1e-2;
  ChainPose pose;
  chain.computePose(q, pose);
  ScaledVector torque;
  applyPointJacobianTranspose(chain, pose, joint, p, n, torque);
  ArmDynamics arm(chain, config, q);
  const JointVector none = JointVector::Zero(q.size());
  arm.step(kStep_s, q, none, torque.head(chain.size()), pose);
  const JointVector speed = (arm.q() - q) / kStep_s;
  return kStep_s / torque.head(chain.size()).dot(speed);
}

TEST(EffectiveMass, IsWhatAHammerFinds) {
  Random random(31);
  const ControllerConfig crops9 = test::crops9Controller();
  for (int i = 0; i < 50; ++i) {
    ArmDynamicsConfig config;
    for (int k = 0; k < 9; ++k) config.bodies.push_back(randomBody(random));
    config.rotor_inertia = random.vector(9, 0.05, 2.0);
    config.gear_stiffness = JointVector::Constant(9, kNoLimit);
    config.gear_damping = JointVector::Zero(9);
    config.servo_bandwidth_hz = 1e-9;
    config.servo_integral_hz = 0.0;
    const JointVector q = random.vector(9, -1.0, 1.0);
    ChainPose pose;
    crops9.chain.computePose(q, pose);
    const int joint = random.integer(2, 8);
    const Vector3 p = pose.p_BaseJoint[joint] + random.vector<Vector3>(3, -0.3, 0.3);
    const Vector3 n = random.vector<Vector3>(3, -1.0, 1.0).normalized();
    const double mass =
        effectiveMass_kg(crops9.chain, pose, massMatrixAt(crops9.chain, config.bodies, q),
                         config.rotor_inertia, joint, p, n);
    EXPECT_NEAR(massThatAHammerFinds(crops9.chain, config, q, joint, p, n), mass, 1e-3 * mass);
  }
}

TEST(EffectiveMass, IsInfiniteWhereNoJointGivesWay) {
  const ControllerConfig crops9 = test::crops9Controller();
  ChainPose pose;
  const JointVector q = JointVector::Zero(9);
  crops9.chain.computePose(q, pose);
  const MassMatrix M = MassMatrix::Identity(9, 9);
  EXPECT_EQ(effectiveMass_kg(crops9.chain, pose, M, JointVector::Zero(9), 1, pose.p_BaseJoint[1],
                             Vector3::UnitX()),
            kNoLimit);
}

}  // namespace
}  // namespace tactus
