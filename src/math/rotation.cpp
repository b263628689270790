#include "tactus/math/rotation.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tactus/math/sin_cos.h"

namespace tactus {
namespace {

/// The angle in 0 .. pi/2 of a point of the unit circle. The first guess is off by a third of a
/// radian at most; each step raises the error to its fifth power.
double firstQuadrantAngle(double sine, double cosine) {
  double angle = 0.5 * std::numbers::pi * (1.0 - cosine);
  for (int i = 0; i < 3; ++i) {
    double s, c;
    sinCos(&angle, 1, &s, &c);
    const double rest = sine * c - cosine * s;  // sin of what is missing
    angle += rest + rest * rest * rest / 6.0;
  }
  return angle;
}

}  // namespace

Matrix3 rotationMatrix(const Vector3& axis, double sine, double cosine) noexcept {
  Matrix3 axis_cross;
  axis_cross << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
  return cosine * Matrix3::Identity() + sine * axis_cross +
         (1.0 - cosine) * axis * axis.transpose();
}

Matrix3 rotationMatrix(const Vector3& rotation_vector) noexcept {
  const double angle = rotation_vector.norm();
  if (angle == 0.0) return Matrix3::Identity();
  double sine, cosine;
  sinCos(&angle, 1, &sine, &cosine);
  return rotationMatrix(rotation_vector / angle, sine, cosine);
}

Vector3 rotationVector(const Matrix3& R) noexcept {
  const Eigen::Quaterniond q(R);
  const double sine = q.vec().norm();
  if (sine == 0.0) return Vector3::Zero();
  const double half_angle = firstQuadrantAngle(sine, std::abs(q.w()));
  return std::copysign(2.0 * half_angle / sine, q.w()) * q.vec();
}

}  // namespace tactus
