#include "tactus/math/sin_cos.h"

#include <bit>
#include <cstdint>

namespace tactus {
namespace {

// pi/2 in three parts of 33 bits and a tail: k * part is exact for |k| < 2^20.
constexpr double kTwoOverPi = 6.36619772367581382433e-01;
constexpr double kPiHalf1 = 1.57079632673412561417e+00;
constexpr double kPiHalf2 = 6.07710050630396597660e-11;
constexpr double kPiHalf3 = 2.02226624871116645580e-21;
// Adding and subtracting 1.5 * 2^52 rounds to the nearest integer, whose low bits are then those of
// the sum.
constexpr double kRoundToInteger = 6755399441055744.0;

double sinPolynomial(double r, double z) {
  const double s =
      -1.66666666666666324348e-01 +
      z * (8.33333333332248946124e-03 +
           z * (-1.98412698298579493134e-04 +
                z * (2.75573137070700676789e-06 +
                     z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))));
  return r + r * z * s;
}

double cosPolynomial(double z) {
  const double c =
      4.16666666666666019037e-02 +
      z * (-1.38888888888741095749e-03 +
           z * (2.48015872894767294178e-05 +
                z * (-2.75573143513906633035e-07 +
                     z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
  const double half = 0.5 * z;
  const double head = 1.0 - half;
  return head + (((1.0 - head) - half) + z * z * c);
}

}  // namespace

// Quadrants are told apart with masks instead of branches, so that the compiler works on two angles
// at a time.
void sinCos(const double* angle, int count, double* sine, double* cosine) noexcept {
  for (int i = 0; i < count; ++i) {
    const double shifted = angle[i] * kTwoOverPi + kRoundToInteger;
    const double k = shifted - kRoundToInteger;
    const double r = ((angle[i] - k * kPiHalf1) - k * kPiHalf2) - k * kPiHalf3;
    const double z = r * r;
    const auto s = std::bit_cast<std::uint64_t>(sinPolynomial(r, z));
    const auto c = std::bit_cast<std::uint64_t>(cosPolynomial(z));
    const auto quadrant = std::bit_cast<std::uint64_t>(shifted);
    const std::uint64_t swap = 0 - (quadrant & 1u);
    const std::uint64_t sine_sign = (quadrant & 2u) << 62;
    const std::uint64_t cosine_sign = ((quadrant + 1u) & 2u) << 62;
    sine[i] = std::bit_cast<double>(((c & swap) | (s & ~swap)) ^ sine_sign);
    cosine[i] = std::bit_cast<double>(((s & swap) | (c & ~swap)) ^ cosine_sign);
  }
}

}  // namespace tactus
