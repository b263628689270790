#include <gtest/gtest.h>

#include <limits>

#include "support/expanded_pseudoinverse.h"
#include "support/random_jacobian.h"
#include "support/random_robot.h"
#include "tactus/math/rotation.h"

/// Null-space motion must not reach the task in any pose, singular ones included.
namespace tactus {
namespace {

constexpr double kLeakAllowed = 1e-12;

void expectNoLeak(test::Random& random, const TaskJacobian& J, const JointVector& weights,
                  const char* kind) {
  const Eigen::MatrixXd N = test::expandPseudoinverse(J, weights).N;
  const Eigen::VectorXd v = random.vector<Eigen::VectorXd>(static_cast<int>(J.cols()), -1.0, 1.0);
  // N is an oblique projector: with very uneven weights N v may be longer than v.
  const double length = std::max(v.norm(), (N * v).norm());
  ASSERT_TRUE(N.allFinite()) << kind;
  ASSERT_LE((J * (N * v)).norm(), kLeakAllowed * J.norm() * length) << kind;
  // Each row by itself, too: a small row must not hide behind a large one.
  for (int row = 0; row < J.rows(); ++row)
    ASSERT_LE(std::abs(J.row(row).dot(N * v)), 1e-10 * J.row(row).norm() * length) << kind << row;
  ASSERT_LE((N * (N * v) - N * v).norm(), 1e-10 * length) << kind;
}

struct RandomPose {
  explicit RandomPose(test::Random& random)
      : n(random.integer(3, kMaxJoints)),
        m(random.integer(2, std::min(n, kMaxTaskSize))),
        weights(random.chance(0.5) ? JointVector(JointVector::Ones(n))
                                   : test::randomWeights(random, n)),
        J(test::randomJacobian(random, test::randomSpectrum(random, m, 0.1, 3.0), weights)) {}

  int n, m;
  JointVector weights;
  TaskJacobian J;
};

TEST(NullSpaceLeak, NoneInRegularAndNearlySingularPoses) {
  test::Random random(71);
  for (int i = 0; i < 2000; ++i) {
    RandomPose pose(random);
    const double smallest = random.logUniform(1e-17, 1.0);
    pose.J = test::randomJacobian(random, test::randomSpectrum(random, pose.m, smallest, 2.0),
                                  pose.weights);
    expectNoLeak(random, pose.J, pose.weights, "near singular");
  }
}

TEST(NullSpaceLeak, NoneWithZeroAndDependentRows) {
  test::Random random(72);
  for (int i = 0; i < 500; ++i) {
    RandomPose pose(random);
    const int target = random.index(pose.m);
    const int source = (target + 1 + random.index(pose.m - 1)) % pose.m;
    TaskJacobian J = pose.J;
    J.row(target).setZero();
    expectNoLeak(random, J, pose.weights, "zero row");
    J.row(target) = pose.J.row(source);
    expectNoLeak(random, J, pose.weights, "equal rows");
    J.row(target) = -random.logUniform(1e-8, 1e8) * pose.J.row(source);
    expectNoLeak(random, J, pose.weights, "parallel rows");
    J.row(target).setZero();
    for (int row = 0; row < pose.m; ++row)
      if (row != target) J.row(target) += random.uniform(-1.0, 1.0) * pose.J.row(row);
    expectNoLeak(random, J, pose.weights, "dependent row");
    J.setZero();
    expectNoLeak(random, J, pose.weights, "no motion at all");
  }
}

TEST(NullSpaceLeak, NoneInStretchedArms) {
  test::Random random(73);
  for (int i = 0; i < 200; ++i) {
    // All axes and offsets along coordinate directions, at multiples of pi/2: exactly singular.
    std::vector<Joint> joints(random.integer(3, 9));
    for (Joint& joint : joints) {
      joint.axis = random.sign() * Vector3::Unit(random.index(3));
      joint.X_ParentJoint.p_AB = 0.3 * Vector3::Unit(random.index(3));
    }
    const int n = static_cast<int>(joints.size());
    const SerialChain chain(joints, {n - 1, {Matrix3::Identity(), Vector3(0.2, 0.0, 0.0)}});
    JointVector q(n);
    for (double& angle : q) angle = random.index(4) * M_PI_2;
    const auto components = test::randomComponents(random);
    const int m = random.integer(1, std::min(n, 6));
    const TaskJacobian J = test::tipJacobian(chain, q, components.data(), m);
    const Eigen::MatrixXd N = test::expandPseudoinverse(J, JointVector::Ones(n)).N;
    ASSERT_TRUE(N.allFinite());
    ASSERT_LE((J * N).norm(), kLeakAllowed * std::max(1.0, J.norm()));
  }
}

TEST(Pseudoinverse, TurnsNoNumberIntoNoNumberAndEnds) {
  test::Random random(74);
  for (const double hostile :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < 200; ++i) {
      RandomPose pose(random);
      const int row = random.index(pose.m);
      pose.J(row, random.index(pose.n)) = hostile;
      const ScaledVector inv_sqrt = test::inverseSquareRoot(pose.weights);
      WeightedPseudoinverse factors;
      factors.factorise(pose.J, inv_sqrt);
      const ScaledVector q_dot =
          factors.expand(factors.solve(TaskVector(TaskVector::Ones(pose.m))));
      ASSERT_FALSE(q_dot.allFinite()) << "row " << row << " of " << pose.m;
    }
  }
}

TEST(Pseudoinverse, HandsANotFiniteTargetOn) {
  test::Random random(75);
  RandomPose pose(random);
  WeightedPseudoinverse factors;
  factors.factorise(pose.J, test::inverseSquareRoot(pose.weights));
  TaskVector w = TaskVector::Zero(pose.m);
  w[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(factors.expand(factors.solve(w)).allFinite());
}

/// A planar arm whose joint frames are rolled: that it cannot leave its plane is a row of rounding,
/// which counts as no direction, or the null space would be another one in each cycle.
TEST(NullSpaceLeak, AComponentThatTheArmCannotMoveTakesNothingOfIt) {
  test::Random random(74);
  for (int run = 0; run < 200; ++run) {
    const int n = random.integer(4, 9);
    std::vector<Joint> joints(n);
    double roll = 0.0;
    for (Joint& joint : joints) {
      joint.X_ParentJoint = {rotationMatrix(random.uniform(-1.0, 1.0) * Vector3::UnitX()),
                             0.3 * Vector3::UnitX()};
      roll += rotationVector(joint.X_ParentJoint.R_AB)[0];
      joint.axis = rotationMatrix(-roll * Vector3::UnitX()) * Vector3::UnitZ();
    }
    const SerialChain chain(joints, {n - 1, {Matrix3::Identity(), 0.2 * Vector3::UnitX()}});
    const JointVector q = random.vector(n, -1.0, 1.0);
    const auto projector = [&](const JointVector& at) {
      constexpr int kPosition[] = {0, 1, 2};
      const TaskJacobian J = test::tipJacobian(chain, at, kPosition, 3);
      return Eigen::MatrixXd(test::expandPseudoinverse(J, JointVector::Ones(n)).N);
    };
    const Eigen::MatrixXd N = projector(q);
    ASSERT_NEAR(N.trace(), n - 2, 1e-9) << run;
    ASSERT_LT((projector(q + 1e-6 * JointVector::Ones(n)) - N).norm(), 1e-3) << run;
  }
}

}  // namespace
}  // namespace tactus
