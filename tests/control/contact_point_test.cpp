#include "tactus/control/contact_point.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <limits>

#include "support/random.h"
#include "support/tactile_samples.h"

namespace tactus {
namespace {

constexpr double kLength_m = 0.38;

TEST(LocateContact, FindsForcePointAndDirectionOfARandomContact) {
  test::Random random(141);
  for (int i = 0; i < 5000; ++i) {
    const double x_m = random.uniform(0.0, kLength_m);
    const double force_N = random.logUniform(0.06, 100.0);
    const double angle_rad = random.uniform(-3.2, 3.2);
    ContactPointState contact;
    locateContact(test::touchAt(x_m, force_N, angle_rad, 1), test::moduleOfLength(kLength_m),
                  contact);
    ASSERT_NEAR(contact.force_N, force_N, 1e-13 * force_N);
    ASSERT_NEAR(contact.position_m, x_m, 1e-12);
    ASSERT_NEAR(contact.direction.norm(), 1.0, 1e-14);
    ASSERT_NEAR(contact.direction.y(), std::cos(angle_rad), 1e-13);
    ASSERT_NEAR(contact.direction.z(), std::sin(angle_rad), 1e-13);
    ASSERT_EQ(contact.direction.x(), 0.0);
  }
}

TEST(LocateContact, KeepsPointAndDirectionWhileTheForceIsTooSmallToTell) {
  ContactPointState contact;
  locateContact(test::touchAt(0.2, 5.0, 0.3, 1), test::moduleOfLength(kLength_m), contact);
  const Vector3 direction = contact.direction;
  for (const double force_N : {0.05, 0.01, 0.0}) {
    locateContact(test::touchAt(0.1, force_N, 2.0, 2), test::moduleOfLength(kLength_m), contact);
    EXPECT_NEAR(contact.force_N, force_N, 1e-15);
    EXPECT_NEAR(contact.position_m, 0.2, 1e-12);
    EXPECT_EQ(contact.direction, direction);
  }
}

TEST(LocateContact, TakesForcesWithoutNormalSquaresForNone) {
  for (const double force_N : {1e-160, 5e-324}) {
    ContactPointState contact;
    locateContact({force_N, -force_N, 0.0, 0.0, 1}, test::moduleOfLength(kLength_m), contact);
    EXPECT_EQ(contact.force_N, 0.0);
  }
}

constexpr double kRadius_m = 0.05;

TactileModuleConfig tellingMomentX() {
  TactileModuleConfig module = test::moduleOfLength(kLength_m);
  module.cover_radius_m = kRadius_m;
  module.feels_moment_x = true;
  return module;
}

/// What a module feels of a force at a point of its frame.
TactileSample sampleOf(const Vector3& p, const Vector3& F) {
  const Vector3 M = p.cross(F);
  return {F.y(), F.z(), M.y(), M.z(), 1, M.x()};
}

/// The force is made of normal and friction, the moment of the force on the cover's surface.
TEST(LocateContact, FindsTheNormalOfAContactThatRubs) {
  test::Random random(142);
  for (int i = 0; i < 5000; ++i) {
    const double angle_rad = random.uniform(-3.2, 3.2);
    const Vector3 normal(0.0, std::cos(angle_rad), std::sin(angle_rad));
    const double force_N = random.logUniform(0.1, 70.0);
    const double mu = random.uniform(0.0, 0.99);
    const double rub_rad = random.uniform(-3.2, 3.2);
    const double along_N = mu * force_N * std::cos(rub_rad);
    const double across_N = mu * force_N * std::sin(rub_rad);
    const double x_m = random.uniform(0.06, kLength_m - 0.06);
    const Vector3 F =
        force_N * normal + along_N * Vector3::UnitX() + across_N * Vector3::UnitX().cross(normal);
    ContactPointState contact;
    locateContact(sampleOf(x_m * Vector3::UnitX() - kRadius_m * normal, F), tellingMomentX(),
                  contact);
    ASSERT_LT((contact.direction - normal).norm(), 1e-12) << mu;
    ASSERT_NEAR(contact.force_N, force_N, 1e-12 * force_N);
    ASSERT_LE(std::abs(contact.position_m - x_m), mu * kRadius_m + 1e-12)
        << "of friction along the axis, which nothing tells";
  }
}

/// A broken channel, or two contacts at once.
TEST(LocateContact, BelievesAMomentAboutTheAxisOnlySoFar) {
  test::Random random(143);
  for (int i = 0; i < 5000; ++i) {
    TactileSample sample =
        test::touchAt(0.2, random.logUniform(0.06, 100.0), random.uniform(-3.2, 3.2), 1);
    ContactPointState plain, contact;
    locateContact(sample, tellingMomentX(), plain);
    sample.moment_x_Nm = random.sign() * random.logUniform(1e-300, 1e300);
    locateContact(sample, tellingMomentX(), contact);
    ASSERT_GE(contact.force_N, 0.707 * plain.force_N);
    ASSERT_LE(contact.force_N, plain.force_N);
    ASSERT_GE(contact.direction.dot(plain.direction), 0.707);
    ASSERT_NEAR(contact.direction.norm(), 1.0, 1e-12);
    ASSERT_EQ(contact.position_m, plain.position_m);
  }
}

TEST(LocateContact, BelievesAMomentOfOneNewtonMetreToo) {
  ContactPointState contact;
  locateContact({0.0, 40.0, 0.0, 0.0, 1, 1.0}, tellingMomentX(), contact);
  EXPECT_NEAR(contact.direction.y(), -0.5, 1e-12);  // 1 Nm / (0.05 m 40 N)
  EXPECT_NEAR(contact.force_N, 40.0 * std::sqrt(0.75), 1e-9);
}

TEST(LocateContact, KeepsThePointOnTheLink) {
  ContactPointState contact;
  locateContact(test::touchAt(-0.3, 5.0, 0.3, 1), test::moduleOfLength(kLength_m), contact);
  EXPECT_EQ(contact.position_m, 0.0);
  locateContact(test::touchAt(2.0, 5.0, 0.3, 1), test::moduleOfLength(kLength_m), contact);
  EXPECT_EQ(contact.position_m, kLength_m);
}

TEST(LocateContact, MixesTwoContactsIntoTheOneThatExplainsThem) {
  // Two parallel forces: one contact at their centre.
  const TactileSample a = test::touchAt(0.1, 2.0, 0.5, 1);
  const TactileSample b = test::touchAt(0.3, 6.0, 0.5, 1);
  ContactPointState contact;
  locateContact({a.force_y_N + b.force_y_N, a.force_z_N + b.force_z_N,
                 a.moment_y_Nm + b.moment_y_Nm, a.moment_z_Nm + b.moment_z_Nm, 1},
                test::moduleOfLength(kLength_m), contact);
  EXPECT_NEAR(contact.force_N, 8.0, 1e-12);
  EXPECT_NEAR(contact.position_m, 0.25, 1e-12);
}

TEST(TactileSample, IsNotCalculatedWithInSubnormalNumbers) {
  const TactileModuleConfig module = test::moduleOfLength(kLength_m);
  for (const double force_N : {5e-324, 1e-300, 1e-160}) {  // of the last the square would be one
    volatile double tiny = force_N;                        // not folded at compile time
    const TactileSample sample{tiny, -tiny, tiny, -tiny, 1};
    ContactPointState contact;
    std::feclearexcept(FE_UNDERFLOW);
    EXPECT_TRUE(isValid(sample, module));
    EXPECT_FALSE(tellsItsPlace(sample, module));
    locateContact(sample, module, contact);
    EXPECT_EQ(std::fetestexcept(FE_UNDERFLOW), 0) << force_N;
  }
}

TEST(TactileSampleIsValid, RefusesWhatNoModuleCanMean) {
  TactileModuleConfig config;
  config.max_force_N = 50.0;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(isValid({}, config));
  EXPECT_TRUE(isValid({30.0, 40.0, 0.0, 0.0, 1}, config)) << "exactly the range";
  EXPECT_FALSE(isValid({30.1, 40.0, 0.0, 0.0, 1}, config));
  for (const double hostile : {nan, inf, -inf}) {
    EXPECT_FALSE(isValid({hostile, 0.0, 0.0, 0.0, 1}, config));
    EXPECT_FALSE(isValid({0.0, hostile, 0.0, 0.0, 1}, config));
    EXPECT_FALSE(isValid({0.0, 0.0, hostile, 0.0, 1}, config));
    EXPECT_FALSE(isValid({0.0, 0.0, 0.0, hostile, 1}, config));
    EXPECT_FALSE(isValid({0.0, 0.0, 0.0, 0.0, 1, hostile}, config));
    EXPECT_FALSE(isValid({hostile, nan, 0.0, 0.0, 1}, config));
  }
}

}  // namespace
}  // namespace tactus
