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

}  // namespace
}  // namespace tactus
