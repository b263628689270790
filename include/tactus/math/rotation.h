#pragma once

#include "tactus/math/types.h"

namespace tactus {

/// Rotation by |v| rad about v / |v|. Own sine, see sin_cos.h.
Matrix3 rotationMatrix(const Vector3& rotation_vector) noexcept;

/// The rotation vector of R, of length 0 to pi. Own arc tangent, for the same reason.
Vector3 rotationVector(const Matrix3& R) noexcept;

}  // namespace tactus
