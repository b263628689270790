#include "tactus/math/mass_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <kdl/chaindynparam.hpp>

#include "support/kdl_chain.h"
#include "support/random_robot.h"

namespace tactus {
namespace {

BodyInertia randomBody(test::Random& random) {
  BodyInertia body;
  body.mass_kg = random.logUniform(0.01, 20.0);
  body.p_JointCom = random.vector<Vector3>(3, -0.3, 0.3);
  // That of a cloud of points, which every body has.
  for (int i = 0; i < 4; ++i) {
    const Vector3 p = random.vector<Vector3>(3, -0.2, 0.2);
    body.I_Com += 0.25 * body.mass_kg * (p.squaredNorm() * Matrix3::Identity() - p * p.transpose());
  }
  return body;
}

KDL::RigidBodyInertia toKdl(const BodyInertia& body) {
  const Matrix3& I = body.I_Com;
  // KDL's constructor takes the inertia about the centre of mass.
  return KDL::RigidBodyInertia(
      body.mass_kg, test::toKdl(body.p_JointCom),
      KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)));
}

/// Each joint with its body, where KDL computes M(q) by an algorithm of its own.
Eigen::MatrixXd kdlMassMatrix(const std::vector<Joint>& joints,
                              const std::vector<BodyInertia>& bodies, const JointVector& q) {
  KDL::Chain chain;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto type =
        joints[i].type == JointType::kPrismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::None), test::toKdl(joints[i].X_ParentJoint)));
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Vector::Zero(), test::toKdl(joints[i].axis), type),
                     KDL::Frame::Identity(), toKdl(bodies[i])));
  }
  KDL::ChainDynParam dynamics(chain, KDL::Vector::Zero());
  KDL::JntSpaceInertiaMatrix M(chain.getNrOfJoints());
  dynamics.JntToMass(test::toKdl(q, static_cast<int>(joints.size())), M);
  return M.data;
}

TEST(MassMatrix, AgreesWithOrocosKdl) {
  test::Random random(91);
  for (int run = 0; run < 500; ++run) {
    const int n = random.integer(2, kMaxJoints);
    const std::vector<Joint> joints = test::randomJoints(random, n);
    const SerialChain chain(joints, {n - 1, {}});
    std::vector<BodyInertia> bodies(n);
    for (BodyInertia& body : bodies) body = randomBody(random);
    const JointVector q = random.vector(n, -3.0, 3.0);
    const MassMatrix M = massMatrixAt(chain, bodies, q);
    const Eigen::MatrixXd expected = kdlMassMatrix(joints, bodies, q);
    ASSERT_LT((M - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff()) << run;
    ASSERT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M).eigenvalues().minCoeff(), 0.0);
  }
}

TEST(MassMatrix, OfBodiesPutTogetherIsTheSumOfTheirs) {
  test::Random random(92);
  for (int run = 0; run < 200; ++run) {
    const int n = random.integer(2, 6);
    const SerialChain chain(test::randomJoints(random, n), {n - 1, {}});
    std::vector<BodyInertia> a(n), b(n), both(n);
    for (int i = 0; i < n; ++i) {
      a[i] = randomBody(random);
      b[i] = randomBody(random);
      both[i] = combined(a[i], b[i]);
    }
    const JointVector q = random.vector(n, -3.0, 3.0);
    const MassMatrix M_a = massMatrixAt(chain, a, q);
    const MassMatrix M_b = massMatrixAt(chain, b, q);
    const MassMatrix M_both = massMatrixAt(chain, both, q);
    EXPECT_LT((M_a + M_b - M_both).norm(), 1e-12 * M_both.norm());
  }
}

TEST(MassMatrix, OfABodyInAnotherFrameIsTheSame) {
  test::Random random(93);
  const BodyInertia body = randomBody(random);
  Pose X_AB;
  X_AB.R_AB = random.rotation();
  X_AB.p_AB = random.vector<Vector3>(3, -1.0, 1.0);
  Pose X_BA;
  X_BA.R_AB = X_AB.R_AB.transpose();
  X_BA.p_AB = -(X_BA.R_AB * X_AB.p_AB);
  const BodyInertia back = transformed(X_BA, transformed(X_AB, body));
  EXPECT_NEAR(back.mass_kg, body.mass_kg, 1e-15);
  EXPECT_LT((back.p_JointCom - body.p_JointCom).norm(), 1e-14);
  EXPECT_LT((back.I_Com - body.I_Com).norm(), 1e-13 * body.I_Com.norm());
}

/// A rod that is hit at its end, free about the other, feels 1 / (a^T M^-1 a) = I / l^2 = m / 3.
TEST(MassMatrix, TellsWhatABlowMeets) {
  Joint hinge;
  hinge.axis = Vector3::UnitZ();
  Joint slide;  // locked by a huge mass
  slide.type = JointType::kPrismatic;
  slide.axis = Vector3::UnitX();
  const SerialChain chain({slide, hinge}, {1, {}});
  BodyInertia rod{3.0, Vector3(0.5, 0, 0), Matrix3::Zero()};
  rod.I_Com(1, 1) = rod.I_Com(2, 2) = 3.0 / 12.0;
  ChainPose pose;
  const JointVector q = JointVector::Zero(2);
  chain.computePose(q, pose);
  MassMatrix M;
  computeMassMatrix(chain, pose, {BodyInertia{1e9}, rod}, M);
  ScaledVector a;
  applyPointJacobianTranspose(chain, pose, 1, Vector3(1.0, 0, 0), Vector3::UnitY(), a);
  const JointVector row = a.head(2);
  EXPECT_NEAR(1.0 / row.dot(M.llt().solve(row)), 1.0, 1e-6);
}

}  // namespace
}  // namespace tactus
