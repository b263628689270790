#include "tactus/analysis/effective_mass.h"

#include <Eigen/Cholesky>

namespace tactus {

double effectiveMass_kg(const SerialChain& chain, const ChainPose& pose, const MassMatrix& M,
                        const JointVector& rotors, int joint, const Vector3& p_Base,
                        const Vector3& n) {
  ScaledVector a_all;
  applyPointJacobianTranspose(chain, pose, joint, p_Base, n, a_all);
  const JointVector a = a_all.head(chain.size());
  MassMatrix all = M;
  all.diagonal() += rotors;
  return 1.0 / a.dot(JointVector(all.llt().solve(a)));
}

}  // namespace tactus
