#pragma once

#include <Eigen/Core>

#include "tactus/math/serial_chain.h"
#include "tactus/math/weighted_pseudoinverse.h"

namespace tactus::test {

using Matrix = Eigen::MatrixXd;

/// J# and N as the matrices that the library never forms, from their action on unit vectors.
struct ExpandedPseudoinverse {
  WeightedPseudoinverse factors;
  Matrix J_sharp;
  Matrix N;
};

inline ScaledVector inverseSquareRoot(const JointVector& weights) {
  return scaled(weights.cwiseSqrt().cwiseInverse(), ScaledVector::Ones());
}

inline ExpandedPseudoinverse expandPseudoinverse(const TaskJacobian& J,
                                                 const JointVector& weights) {
  const int m = static_cast<int>(J.rows());
  const int n = static_cast<int>(J.cols());
  const ScaledVector inv_sqrt = inverseSquareRoot(weights);
  ExpandedPseudoinverse result{{}, Matrix(n, m), Matrix(n, n)};
  result.factors.factorise(J, inv_sqrt);
  for (int i = 0; i < m; ++i) {
    const ScaledVector column =
        result.factors.expand(result.factors.solve(TaskVector(TaskVector::Unit(m, i))));
    result.J_sharp.col(i) = column.cwiseProduct(inv_sqrt).head(n);
  }
  for (int i = 0; i < n; ++i) {
    ScaledVector v = ScaledVector::Zero();
    v[i] = 1.0 / inv_sqrt[i];
    v -= result.factors.expand(result.factors.project(v));
    result.N.col(i) = v.cwiseProduct(inv_sqrt).head(n);
  }
  return result;
}

inline TaskJacobian tipJacobian(const SerialChain& chain, const JointVector& q,
                                const int* components, int count) {
  ChainPose pose;
  chain.computePose(q, pose);
  TaskJacobian J;
  computeTipJacobian(chain, pose, framePosition(pose, chain.tip()), components, count, J);
  return J;
}

}  // namespace tactus::test
