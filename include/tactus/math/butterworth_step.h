#pragma once

namespace tactus {

/// One step of the 3rd-order Butterworth low pass of filter.h for each entry of a vector, direct
/// form II transposed, with states s0, s1 and s2. K = tan(pi cutoff / rate), > 0.
template <class Vector>
void butterworthStep(const Vector& input, double K, Vector& s0, Vector& s1, Vector& s2,
                     Vector& output) noexcept {
  const double K2 = K * K;
  const double K3 = K2 * K;
  const double inv_a0 = 1.0 / (K3 + 2.0 * K2 + 2.0 * K + 1.0);
  const double b = K3 * inv_a0;
  const double a1 = (3.0 * K3 + 2.0 * K2 - 2.0 * K - 3.0) * inv_a0;
  const double a2 = (3.0 * K3 - 2.0 * K2 - 2.0 * K + 3.0) * inv_a0;
  const double a3 = (K3 - 2.0 * K2 + 2.0 * K - 1.0) * inv_a0;
  output = b * input + s0;
  s0 = 3.0 * b * input - a1 * output + s1;
  s1 = 3.0 * b * input - a2 * output + s2;
  s2 = b * input - a3 * output;
}

}  // namespace tactus
