#include "tactus/control/friction_cone.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_robot.h"
#include "support/task_kinematics.h"

namespace tactus {
namespace {

constexpr double kDifference = 1e-6;

struct ConeCase {
  explicit ConeCase(test::Random& random)
      : n(random.integer(3, 9)), chain(test::randomChain(random, n)), q(random.vector(n, -1, 1)) {
    module.link = test::randomFrame(random, random.integer(0, n - 1));
    module.cover_radius_m = random.uniform(0.01, 0.1);
    mu = random.uniform(0.05, 1.0);
    contact.position_m = random.uniform(0.0, 0.5);
    const double angle = random.uniform(-3.0, 3.0);
    contact.direction = Vector3(0.0, std::cos(angle), std::sin(angle));
    const ScaledVector ones = scaled(JointVector(JointVector::Ones(n)), ScaledVector::Ones());
    test::computeTaskKinematics(chain, q, {0, 1}, ones, kinematics);
    const FrictionCone cone(module, mu);
    cone.add(chain, kinematics, contact.direction,
             cone.around({contact.position_m, contact.position_m}), ones, rows);
  }

  Vector3 pointInBase(const JointVector& at, double position_m) const {
    ChainPose pose;
    chain.computePose(at, pose);
    const Pose X = framePose(pose, module.link);
    return X.p_AB + position_m * X.R_AB.col(0);
  }

  int n;
  SerialChain chain;
  JointVector q;
  TactileModuleConfig module;
  double mu = 0.0;
  ContactPointState contact;
  TaskKinematics kinematics;
  SpeedRows rows;
};

/// a^T q_dot is the speed of the shifted point along the edge of the cone, by finite differences.
TEST(FrictionCone, CornersAreEdgesAtBothEnds) {
  test::Random random(321);
  for (int i = 0; i < 300; ++i) {
    const ConeCase c(random);
    ASSERT_EQ(c.rows.size, 4);
    ChainPose pose = c.kinematics.pose;
    const Matrix3 R_BaseModule = framePose(pose, c.module.link).R_AB;
    for (int row = 0; row < 4; ++row) {
      const double k = row < 2 ? 1.0 : -1.0;
      const double j = row % 2 == 0 ? 1.0 : -1.0;
      const Vector3 edge =
          R_BaseModule *
          (Eigen::AngleAxisd(j * std::atan(c.mu), Vector3::UnitX()) * c.contact.direction);
      const double at_m = c.contact.position_m + k * c.mu * c.module.cover_radius_m;
      for (int joint = 0; joint < c.n; ++joint) {
        JointVector before = c.q;
        JointVector after = c.q;
        before[joint] -= kDifference;
        after[joint] += kDifference;
        const Vector3 velocity =
            (c.pointInBase(after, at_m) - c.pointInBase(before, at_m)) / (2.0 * kDifference);
        ASSERT_NEAR(c.rows.row[row].a_scaled[joint], edge.dot(velocity), 1e-8) << i;
      }
      ASSERT_EQ(c.rows.row[row].a_task,
                c.kinematics.pseudoinverse.project(c.rows.row[row].a_scaled));
    }
  }
}

/// So a motion that keeps the corners approaches along no normal of the cone faster than they let.
TEST(FrictionCone, EveryNormalLiesBetweenItsCorners) {
  test::Random random(322);
  for (int i = 0; i < 300; ++i) {
    const ConeCase c(random);
    const double angle = random.uniform(-1.0, 1.0) * std::atan(c.mu);
    const double shift = random.uniform(-1.0, 1.0);
    ContactPointState other = c.contact;
    other.direction = Eigen::AngleAxisd(angle, Vector3::UnitX()) * c.contact.direction;
    other.position_m += shift * c.mu * c.module.cover_radius_m;
    SpeedRows rows;
    FrictionCone(c.module, 0.0)
        .add(c.chain, c.kinematics, other.direction, {other.position_m, other.position_m},
             scaled(JointVector(JointVector::Ones(c.n)), ScaledVector::Ones()), rows);
    const double edge = std::atan(c.mu);
    const double share[] = {std::sin(edge + angle) / std::sin(2.0 * edge),
                            std::sin(edge - angle) / std::sin(2.0 * edge)};
    // Of what the corners let, see ApproachLimit::limitRows().
    ASSERT_LE((share[0] + share[1]) * FrictionCone(c.module, c.mu).cosine(), 1.0 + 1e-12);
    ScaledVector sum = ScaledVector::Zero();
    for (int row = 0; row < 4; ++row) {
      const double end = 0.5 * (row < 2 ? 1.0 + shift : 1.0 - shift);
      ASSERT_GE(end * share[row % 2], 0.0);
      sum += end * share[row % 2] * c.rows.row[row].a_scaled;
    }
    ASSERT_LT((sum - rows.row[0].a_scaled).norm(), 1e-9 * (1.0 + sum.norm())) << i;
  }
}

}  // namespace
}  // namespace tactus
