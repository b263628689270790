#include "tactus/analysis/home_pose.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "support/random_robot.h"

namespace tactus {
namespace {

/// By differences, apart from the code's Jacobian: of the tool's position, base frame.
Eigen::MatrixXd positionDifferences(const SerialChain& chain, const JointVector& q) {
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd J(3, q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    JointVector ahead = q, behind = q;
    ahead[i] += kStep;
    behind[i] -= kStep;
    J.col(i) = (tipPose(chain, ahead).p_AB - tipPose(chain, behind).p_AB) / (2.0 * kStep);
  }
  return J;
}

double smallestOf(const Eigen::MatrixXd& J) { return J.jacobiSvd().singularValues().minCoeff(); }

JointLimits drawnLimits(test::Random& random, int joints) {
  JointLimits limits = test::noLimits(joints);
  for (int i = 0; i < joints; ++i) {
    limits.max_velocity[i] = random.logUniform(0.1, 3.0);
    if (random.chance(0.2)) continue;
    limits.lower[i] = random.uniform(-3.0, 2.0);
    limits.upper[i] = limits.lower[i] + random.logUniform(0.01, 4.0);
  }
  return limits;
}

TEST(HomePose, IsFarFromLimitsAndSingularitiesAndLeavesRoomForTheFirstMotion) {
  test::Random random(5);
  for (int i = 0; i < 100; ++i) {
    const int joints = random.integer(2, 16);
    const SerialChain chain = test::randomChain(random, joints);
    const JointLimits limits = drawnLimits(random, joints);
    const HomePose home = findHome(chain, limits);
    for (int j = 0; j < joints; ++j) {
      const double range = limits.upper[j] - limits.lower[j];
      EXPECT_LE(std::abs(home.q[j]), 5.0);
      if (range < kNoLimit) {
        EXPECT_GE(home.q[j], limits.lower[j] + 0.2 * range);
        EXPECT_LE(home.q[j], limits.upper[j] - 0.2 * range);
      }
    }
    if (home.task.components[0] >= 3) continue;
    const Eigen::MatrixXd J = positionDifferences(chain, home.q);
    Eigen::MatrixXd rows(home.task.size, joints);
    for (int k = 0; k < home.task.size; ++k) rows.row(k) = J.row(home.task.components[k]);
    EXPECT_NEAR(home.smallest_singular_value, smallestOf(rows), 1e-5);
    const Waypoint way = findFirstMotion(chain, limits, home);
    EXPECT_GT(way.displacement_m.norm(), 0.0);
    EXPECT_LE(way.displacement_m.norm(), 0.05 + 1e-12);
    EXPECT_LE(way.speed_m_per_s, 0.02 + 1e-12);
    Eigen::VectorXd w(home.task.size);
    for (int k = 0; k < home.task.size; ++k) w[k] = way.displacement_m[home.task.components[k]];
    const Eigen::VectorXd dq = rows.completeOrthogonalDecomposition().solve(w);
    const double duration_s = way.displacement_m.norm() / way.speed_m_per_s;
    for (int j = 0; j < joints; ++j) {
      EXPECT_LE(std::abs(dq[j]) / duration_s, 0.21 * limits.max_velocity[j]);
      const double q_end = home.q[j] + dq[j];
      EXPECT_GT(q_end, limits.lower[j]);
      EXPECT_LT(q_end, limits.upper[j]);
    }
  }
}

TEST(HomePose, BeatsPosesByChance) {
  test::Random random(6);
  int better = 0, poses = 0;
  for (int i = 0; i < 20; ++i) {
    const SerialChain chain = test::randomChain(random, 7);
    const JointLimits limits = test::noLimits(7);
    const HomePose home = findHome(chain, limits);
    ASSERT_EQ(home.task.size, 3);
    for (int k = 0; k < 50; ++k, ++poses) {
      JointVector q = random.vector(7, -1.2, 1.2);
      for (const int j : chain.prismaticJoints()) q[j] *= 0.25;
      better += smallestOf(positionDifferences(chain, q)) < home.smallest_singular_value;
    }
  }
  EXPECT_GT(better, 0.98 * poses);
}

TEST(HomePose, OfAnArmThatOnlyTurnsItsToolTheTaskIsARotation) {
  std::vector<Joint> joints(2);
  joints[0].axis = Vector3::UnitX();
  joints[1].axis = Vector3::UnitZ();
  const SerialChain chain(joints, {1, Pose{}});
  JointLimits limits = test::noLimits(2);
  limits.max_velocity.setOnes();
  const HomePose home = findHome(chain, limits);
  EXPECT_EQ(home.task.size, 1);
  EXPECT_GE(home.task.components[0], 3);
  EXPECT_GT(home.smallest_singular_value, 0.5);
  EXPECT_GT(findFirstMotion(chain, limits, home).rotation_vector_rad.norm(), 0.05);
}

}  // namespace
}  // namespace tactus
