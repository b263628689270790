#include "tactus/math/rotation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "support/random.h"

namespace tactus {
namespace {

/// Angles over the whole range, close to its ends above all.
double randomAngle(test::Random& random) {
  const double near_end = std::pow(10.0, random.uniform(-12.0, 0.0));
  switch (random.integer(0, 2)) {
    case 0:
      return near_end;
    case 1:
      return std::numbers::pi - near_end;
    default:
      return random.uniform(0.0, std::numbers::pi);
  }
}

TEST(Rotation, MatrixIsThatOfAngleAndAxis) {
  test::Random random(401);
  for (int i = 0; i < 3000; ++i) {
    const Vector3 axis = random.unitVector();
    const double angle = 2.0 * randomAngle(random);
    const Matrix3 expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    ASSERT_TRUE(rotationMatrix(angle * axis).isApprox(expected, 1e-14)) << angle;
  }
  EXPECT_EQ(rotationMatrix(Vector3::Zero()), Matrix3::Identity());
}

TEST(Rotation, VectorLeadsBackToTheMatrix) {
  test::Random random(402);
  for (int i = 0; i < 3000; ++i) {
    const Matrix3 R = rotationMatrix(randomAngle(random) * random.unitVector());
    const Vector3 v = rotationVector(R);
    ASSERT_LE(v.norm(), std::numbers::pi * (1.0 + 1e-15));
    ASSERT_LT((rotationMatrix(v) - R).norm(), 4e-15);
  }
  EXPECT_EQ(rotationVector(Matrix3::Identity()), Vector3::Zero());
}

TEST(Rotation, VectorKeepsItsDigitsWhereItIsSmall) {
  test::Random random(403);
  for (int i = 0; i < 3000; ++i) {
    const Vector3 v = std::pow(10.0, random.uniform(-9.0, 0.0)) * random.unitVector();
    ASSERT_LT((rotationVector(rotationMatrix(v)) - v).norm(), 1e-15 + 1e-14 * v.norm());
  }
}

/// Of the turn from R to R_d, both of which turn by themselves.
TEST(Rotation, VectorChangesAsItsJacobianSays) {
  test::Random random(404);
  constexpr double kStep_s = 1e-6;
  for (int i = 0; i < 3000; ++i) {
    const Vector3 phi = std::min(randomAngle(random), 3.1) * random.unitVector();
    const Matrix3 R = random.rotation();
    const Matrix3 R_d = rotationMatrix(phi) * R;
    const Vector3 omega = random.vector<Vector3>(3, -1.0, 1.0);
    const Vector3 omega_d = random.vector<Vector3>(3, -1.0, 1.0);
    const auto after = [&](double t_s) {
      return rotationVector(rotationMatrix(t_s * omega_d) * R_d *
                            (rotationMatrix(t_s * omega) * R).transpose());
    };
    const Vector3 expected = (after(kStep_s) - after(-kStep_s)) / (2.0 * kStep_s);
    const Matrix3 Jl_inverse = inverseLeftJacobian(phi);
    const Vector3 phi_dot = Jl_inverse * omega_d - Jl_inverse.transpose() * omega;
    ASSERT_LT((phi_dot - expected).norm(), 2e-8) << phi.norm();
  }
  EXPECT_EQ(inverseLeftJacobian(Vector3::Zero()), Matrix3::Identity());
}

TEST(Rotation, JacobianChangesAsItsRateSays) {
  test::Random random(405);
  constexpr double kStep_s = 1e-5;
  for (int i = 0; i < 3000; ++i) {
    const Vector3 phi = randomAngle(random) * random.unitVector();
    const Vector3 phi_dot = random.vector<Vector3>(3, -1.0, 1.0);
    const Matrix3 expected = (inverseLeftJacobian(phi + kStep_s * phi_dot) -
                              inverseLeftJacobian(phi - kStep_s * phi_dot)) /
                             (2.0 * kStep_s);
    ASSERT_LT((inverseLeftJacobianRate(phi, phi_dot) - expected).norm(), 1e-9) << phi.norm();
  }
}

/// Where its series ends, and at half a turn.
TEST(Rotation, JacobianIsContinuousAndThatOfTheFormula) {
  for (const double theta : {0.1, std::numbers::pi}) {
    const Vector3 below = theta * (1.0 - 1e-12) * Vector3(0.6, 0.0, 0.8);
    const Vector3 above = theta * (1.0 + 1e-12) * Vector3(0.6, 0.0, 0.8);
    EXPECT_LT((inverseLeftJacobian(below) - inverseLeftJacobian(above)).norm(), 1e-11);
    EXPECT_LT((inverseLeftJacobianRate(below, Vector3::Ones()) -
               inverseLeftJacobianRate(above, Vector3::Ones()))
                  .norm(),
              1e-10);
  }
  // Half a turn about z: c = 1 / pi^2.
  Matrix3 expected;
  const double half_pi = 0.5 * std::numbers::pi;
  expected << 0.0, half_pi, 0.0, -half_pi, 0.0, 0.0, 0.0, 0.0, 1.0;
  const Vector3 half_turn(0.0, 0.0, std::numbers::pi);
  EXPECT_LT((inverseLeftJacobian(half_turn) - expected).norm(), 1e-15);
}

}  // namespace
}  // namespace tactus
