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

Matrix3 cross(const Vector3& v) {
  Matrix3 v_cross;
  v_cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return v_cross;
}

/// c of Jl^-1, and what its derivative by theta is of theta.
struct SquareShare {
  double c, slope_by_theta;
};

SquareShare squareShare(double theta) {
  constexpr double kSeries = 0.1;  // below it the next terms are less than the digits lost above it
  const double t2 = theta * theta;
  if (theta < kSeries)
    return {1.0 / 12.0 + t2 * (1.0 / 720.0 + t2 * (1.0 / 30240.0 + t2 / 1209600.0)),
            1.0 / 360.0 + t2 * (1.0 / 7560.0 + t2 / 201600.0)};
  const double half = 0.5 * theta;
  double sine, cosine;
  sinCos(&half, 1, &sine, &cosine);
  const double half_cotangent = half * cosine / sine;
  return {(1.0 - half_cotangent) / t2,
          (half_cotangent - 2.0 + half * half / (sine * sine)) / (t2 * t2)};
}

}  // namespace

Matrix3 rotationMatrix(const Vector3& axis, double sine, double cosine) noexcept {
  return cosine * Matrix3::Identity() + sine * cross(axis) +
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

Matrix3 inverseLeftJacobian(const Vector3& phi) noexcept {
  const Matrix3 phi_cross = cross(phi);
  return Matrix3::Identity() - 0.5 * phi_cross + squareShare(phi.norm()).c * phi_cross * phi_cross;
}

Matrix3 inverseLeftJacobianRate(const Vector3& phi, const Vector3& phi_dot) noexcept {
  const Matrix3 p = cross(phi), v = cross(phi_dot);
  const SquareShare share = squareShare(phi.norm());
  return -0.5 * v + share.c * (v * p + p * v) + phi.dot(phi_dot) * share.slope_by_theta * p * p;
}

}  // namespace tactus
