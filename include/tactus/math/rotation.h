#pragma once

#include <numbers>

#include "tactus/math/types.h"

namespace tactus {

/// Of a turn that is asked for: closer to half a turn rounding decides which way round it goes.
inline constexpr double kMostTurn_rad = std::numbers::pi - 1e-9;

/// Rotation by |v| rad about v / |v|. Own sine, see sin_cos.h.
Matrix3 rotationMatrix(const Vector3& rotation_vector) noexcept;

/// Rotation about a unit axis by the angle with this sine and cosine.
Matrix3 rotationMatrix(const Vector3& axis, double sine, double cosine) noexcept;

/// The rotation vector of R, of length 0 to pi. Own arc tangent, for the same reason.
Vector3 rotationVector(const Matrix3& R) noexcept;

/// Jl^-1(phi): how the rotation vector phi of R_d R^T, the turn from R to R_d, changes with the
/// angular velocities of both (base frame, rad/s):
///   phi_dot = Jl^-1(phi) omega_d - Jl^-T(phi) omega
///   Jl^-1(phi) = I - [phi]x / 2 + c [phi]x^2,  c = (1 - theta/2 cot(theta/2)) / theta^2
/// with theta = |phi|, at most pi. Source: Sola, Deray, Atchuthan, "A micro Lie theory for state
/// estimation in robotics" (2018), (146).
Matrix3 inverseLeftJacobian(const Vector3& phi) noexcept;

/// d/dt of that, 1/s, while phi changes by phi_dot.
Matrix3 inverseLeftJacobianRate(const Vector3& phi, const Vector3& phi_dot) noexcept;

}  // namespace tactus
