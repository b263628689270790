#include "tactus/math/filter.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tactus {

namespace {

constexpr double kLn2High = 6.93147180369123816490e-01;  ///< 33 bits: k times it is exact
constexpr double kLn2Low = 1.90821492927058770002e-10;

/// exp(-r) - 1 for |r| <= ln(2) / 2 by its series, up to the term that no longer counts.
double expMinusOne(double r) {
  constexpr int kTerms = 14;
  static constexpr auto kInverse = [] {
    std::array<double, kTerms + 1> inverse{};
    for (int n = 1; n <= kTerms; ++n) inverse[n] = 1.0 / n;
    return inverse;
  }();
  double sum = 0.0;
  for (int n = kTerms; n >= 1; --n) sum = (1.0 + sum) * (-r * kInverse[n]);
  return sum;
}

}  // namespace

/// Not libm's expm1, which differs between processors; see sin_cos.h.
double lagShare(double dt_s, double time_constant_s) noexcept {
  if (!(time_constant_s > 0.0)) return 1.0;
  const double x = dt_s / time_constant_s;
  if (!(x < 40.0)) return 1.0;  // exp(-40) does not change 1
  const double k = std::floor(x / (kLn2High + kLn2Low) + 0.5);
  const double e = expMinusOne((x - k * kLn2High) - k * kLn2Low);
  return k == 0.0 ? -e : 1.0 - std::ldexp(1.0 + e, -static_cast<int>(k));
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
  state_[0] = flushed(b_[1] * input - a_[1] * output + state_[1]);
  state_[1] = flushed(b_[2] * input - a_[2] * output + state_[2]);
  state_[2] = flushed(b_[3] * input - a_[3] * output);
  return output;
}

}  // namespace tactus
