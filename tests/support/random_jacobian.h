#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <vector>

#include "support/random.h"

namespace tactus::test {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Rows of random orthonormal directions.
inline LongMatrix randomOrthogonal(Random& random, int size) {
  LongMatrix A(size, size);
  for (int i = 0; i < size * size; ++i) A.data()[i] = random.uniform(-1.0, 1.0);
  return Eigen::HouseholderQR<LongMatrix>(A).householderQ();
}

/// J with the given singular values of J W^-1/2, in random directions.
inline TaskJacobian randomJacobian(Random& random, const std::vector<double>& singular_values,
                                   const JointVector& weights) {
  const int m = static_cast<int>(singular_values.size());
  const int n = static_cast<int>(weights.size());
  LongMatrix S = LongMatrix::Zero(m, n);
  for (int i = 0; i < m; ++i) S(i, i) = singular_values[i];
  const LongMatrix scaled_J = randomOrthogonal(random, m) * S * randomOrthogonal(random, n);
  const LongMatrix sqrt_weights = weights.cwiseSqrt().cast<long double>();
  return (scaled_J * sqrt_weights.col(0).asDiagonal()).cast<double>();
}

/// `count` singular values between `smallest` and `largest`, both present if there are two.
inline std::vector<double> randomSpectrum(Random& random, int count, double smallest,
                                          double largest) {
  std::vector<double> values(count);
  for (double& value : values) value = random.logUniform(smallest, largest);
  values.front() = largest;
  values.back() = smallest;
  return values;
}

}  // namespace tactus::test
