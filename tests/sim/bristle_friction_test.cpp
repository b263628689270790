#include "tactus/sim/bristle_friction.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace tactus {
namespace {

constexpr double kMu = 0.4;
constexpr double kShear_N_per_m = 2000.0;

TEST(BristleFriction, SticksAsASpringAndSlipsAtMuTimesTheNormalForce) {
  BristleFriction friction(kMu, kShear_N_per_m);
  const Vector3 normal = Vector3::UnitY();
  const double slips_m = kMu * 10.0 / kShear_N_per_m;
  for (int i = 1; i <= 40; ++i) {
    const Vector3 force = friction.update(0.1 * slips_m * Vector3::UnitX(), normal, 10.0);
    const double expected = -kShear_N_per_m * std::min(0.1 * i, 1.0) * slips_m;
    EXPECT_NEAR(force.x(), expected, 1e-12) << i;
    EXPECT_EQ(force.y(), 0.0);
  }
  // Back from slipping it sticks at once, with the whole stretch behind it.
  const Vector3 back = friction.update(-0.5 * slips_m * Vector3::UnitX(), normal, 10.0);
  EXPECT_NEAR(back.x(), -0.5 * kMu * 10.0, 1e-12);
  friction.release();
  EXPECT_EQ(friction.update(Vector3::Zero(), normal, 10.0), Vector3(Vector3::Zero()));
}

/// Whatever slides how: never more than mu, never along the normal, and no work is won in total.
TEST(BristleFriction, NeverExceedsTheConeNorGivesWork) {
  test::Random random(511);
  for (int run = 0; run < 200; ++run) {
    BristleFriction friction(kMu, kShear_N_per_m);
    const Vector3 normal = random.unitVector();
    double work_J = 0.0;
    for (int i = 0; i < 500; ++i) {
      const Vector3 slide = 1e-3 * random.vector<Vector3>(3, -1.0, 1.0);
      const double normal_N = random.uniform(0.0, 20.0);
      const Vector3 force = friction.update(slide, normal, normal_N);
      ASSERT_LE(force.norm(), kMu * normal_N * (1.0 + 1e-12));
      ASSERT_NEAR(force.dot(normal), 0.0, 1e-12 * kShear_N_per_m);
      work_J += force.dot(slide);
      ASSERT_LT(work_J, 1e-12) << "it gives more than was stored";
    }
    EXPECT_LT(work_J, 0.0);
  }
}

TEST(BristleFriction, FollowsANormalThatTurns) {
  test::Random random(512);
  BristleFriction friction(kMu, kShear_N_per_m);
  for (int i = 0; i < 1000; ++i) {
    const Vector3 normal = random.unitVector();
    const Vector3 force = friction.update(1e-4 * random.unitVector(), normal, 5.0);
    EXPECT_NEAR(force.dot(normal), 0.0, 1e-11);
    EXPECT_TRUE(force.allFinite());
  }
}

}  // namespace
}  // namespace tactus
