#pragma once

#include "tactus/math/types.h"

namespace tactus {

/// Rotation by |v| rad about v / |v|. Own sine, see sin_cos.h.
Matrix3 rotationMatrix(const Vector3& rotation_vector) noexcept;

/// Rotation about a unit axis by the angle with this sine and cosine.
Matrix3 rotationMatrix(const Vector3& axis, double sine, double cosine) noexcept;

/// The rotation vector of R, of length 0 to pi. Own arc tangent, for the same reason.
Vector3 rotationVector(const Matrix3& R) noexcept;

}  // namespace tactus
