#include "tactus/math/filter.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tactus {

double lagShare(double dt_s, double time_constant_s) noexcept {
  return time_constant_s > 0.0 ? -std::expm1(-dt_s / time_constant_s) : 1.0;
}

/// H(s) = 1 / ((s + 1)(s^2 + s + 1)) in s / w_c, with s / w_c = (1/K) (z - 1)/(z + 1) and
/// K = tan(pi cutoff / rate).
ButterworthLowPass::ButterworthLowPass(double cutoff_hz, double rate_hz) {
  if (!(cutoff_hz > 0.0 && cutoff_hz < 0.5 * rate_hz))
    throw std::invalid_argument("filter cut-off must lie between 0 and half the rate");
  const double K = std::tan(std::numbers::pi * cutoff_hz / rate_hz);
  const double K2 = K * K;
  const double K3 = K2 * K;
  const double a0 = K3 + 2.0 * K2 + 2.0 * K + 1.0;
  b_ = {K3 / a0, 3.0 * K3 / a0, 3.0 * K3 / a0, K3 / a0};
  a_ = {1.0, (3.0 * K3 + 2.0 * K2 - 2.0 * K - 3.0) / a0, (3.0 * K3 - 2.0 * K2 - 2.0 * K + 3.0) / a0,
        (K3 - 2.0 * K2 + 2.0 * K - 1.0) / a0};
}

double ButterworthLowPass::update(double input) noexcept {
  const double output = b_[0] * input + state_[0];
  state_[0] = b_[1] * input - a_[1] * output + state_[1];
  state_[1] = b_[2] * input - a_[2] * output + state_[2];
  state_[2] = b_[3] * input - a_[3] * output;
  return output;
}

}  // namespace tactus
