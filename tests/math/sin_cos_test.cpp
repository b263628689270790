#include "tactus/math/sin_cos.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/random.h"

namespace tactus {
namespace {

constexpr double kDocumentedError = 3e-16;

double largestError(double angle) {
  double sine;
  double cosine;
  sinCos(&angle, 1, &sine, &cosine);
  const long double exact = angle;
  return static_cast<double>(
      std::max(std::abs(sine - std::sin(exact)), std::abs(cosine - std::cos(exact))));
}

TEST(SinCos, KeepsItsErrorOverTheDocumentedRange) {
  test::Random random(1);
  for (int i = 0; i < 300000; ++i) {
    const double angle = random.uniform(-1e5, 1e5);
    ASSERT_LT(largestError(angle), kDocumentedError) << std::hexfloat << angle;
  }
}

TEST(SinCos, KeepsItsErrorOfSmallAnglesOfAnySize) {
  test::Random random(2);
  for (int i = 0; i < 100000; ++i) {
    const double angle = random.sign() * random.logUniform(1e-320, 10.0);
    ASSERT_LT(largestError(angle), kDocumentedError) << std::hexfloat << angle;
  }
}

TEST(SinCos, KeepsItsErrorAtOctantBorders) {
  for (int octant = -127323; octant <= 127323; ++octant) {  // up to 1e5
    const double border = octant * std::numbers::pi / 4.0;
    ASSERT_LT(largestError(border), kDocumentedError) << octant;
    ASSERT_LT(largestError(std::nextafter(border, 1e6)), kDocumentedError) << octant;
    ASSERT_LT(largestError(std::nextafter(border, -1e6)), kDocumentedError) << octant;
  }
}

TEST(SinCos, IsExactAtRestAndOddAndEven) {
  const double zero = 0.0;
  double sine;
  double cosine;
  sinCos(&zero, 1, &sine, &cosine);
  EXPECT_EQ(sine, 0.0);
  EXPECT_EQ(cosine, 1.0);
  test::Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double angle = random.uniform(0.0, 1e3);
    const double both[2] = {angle, -angle};
    double sines[2];
    double cosines[2];
    sinCos(both, 2, sines, cosines);
    EXPECT_EQ(sines[0], -sines[1]) << angle;
    EXPECT_EQ(cosines[0], cosines[1]) << angle;
  }
}

TEST(SinCos, TurnsNoNumberIntoNoNumber) {
  const double hostile[3] = {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()};
  double sines[3];
  double cosines[3];
  sinCos(hostile, 3, sines, cosines);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(std::isfinite(sines[i]));
    EXPECT_FALSE(std::isfinite(cosines[i]));
  }
}

}  // namespace
}  // namespace tactus
