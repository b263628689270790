#pragma once

#include "tactus/math/mass_matrix.h"

namespace tactus {

/// What a blow along a unit vector n at a point of the body that moves with `joint` meets, kg:
/// 1 / (n^T J M^-1 J^T n) (Khatib, 1995), M being that of the chain with `rotors` on its diagonal,
/// which are zero where gears give way. p_Base and n: base frame. Infinite where no joint moves the
/// point along n; needs M positive definite.
double effectiveMass_kg(const SerialChain& chain, const ChainPose& pose, const MassMatrix& M,
                        const JointVector& rotors, int joint, const Vector3& p_Base,
                        const Vector3& n);

}  // namespace tactus
