#include <gtest/gtest.h>

#include "support/crops9.h"
#include "support/random.h"
#include "tactus/sim/obstacle.h"

namespace tactus {
namespace {

ObstacleConfig randomObstacle(test::Random& random) {
  ObstacleConfig obstacle;
  obstacle.stiffness_N_per_m = random.logUniform(30.0, 1e6);
  double force_N = 0.0;
  for (int layers = random.index(4); layers > 0; --layers) {
    force_N += random.uniform(0.5, 10.0);
    obstacle.foam.push_back({random.logUniform(300.0, 1e5), force_N});
  }
  return obstacle;
}

/// How far foam, solid and arm give way together under a force.
double compression_m(const ObstacleConfig& obstacle, double robot_N_per_m, double force_N) {
  double way_m = force_N / obstacle.stiffness_N_per_m + force_N / robot_N_per_m;
  double carried_N = 0.0;
  for (const FoamLayer& layer : obstacle.foam) {
    const double part_N = std::min(force_N, layer.until_force_N) - carried_N;
    if (part_N <= 0.0) break;
    way_m += part_N / layer.stiffness_N_per_m;
    carried_N = layer.until_force_N;
  }
  return way_m;
}

TEST(ContactSpring, IsFoamSolidAndArmInSeries) {
  test::Random random(301);
  for (int i = 0; i < 2000; ++i) {
    const ObstacleConfig obstacle = randomObstacle(random);
    const double robot_N_per_m = random.chance(0.3) ? kNoLimit : random.logUniform(1e3, 1e5);
    const ContactSpring spring(obstacle, robot_N_per_m);
    const double force_N = random.logUniform(1e-3, 100.0);
    ASSERT_NEAR(spring.force_N(compression_m(obstacle, robot_N_per_m, force_N)), force_N,
                1e-9 * (1.0 + force_N));
  }
}

TEST(ContactSpring, NeverPullsAndStartsAtTheSurface) {
  test::Random random(302);
  for (int i = 0; i < 100; ++i) {
    const ContactSpring spring(randomObstacle(random), 7000.0);
    EXPECT_EQ(spring.force_N(0.0), 0.0);
    EXPECT_EQ(spring.force_N(-random.logUniform(1e-9, 10.0)), 0.0);
    EXPECT_GT(spring.force_N(1e-9), 0.0);
  }
}

TEST(ContactSpring, IsContinuousAndRising) {
  test::Random random(303);
  for (int i = 0; i < 100; ++i) {
    const ObstacleConfig obstacle = randomObstacle(random);
    const ContactSpring spring(obstacle, 7000.0);
    const double step_m = 1e-6;
    double before_N = 0.0;
    for (double way_m = step_m; way_m < 0.03; way_m += step_m) {
      const double force_N = spring.force_N(way_m);
      ASSERT_GT(force_N, before_N);
      ASSERT_LE(force_N - before_N, 7000.0 * step_m * (1.0 + 1e-9)) << "no slope above the arm's";
      before_N = force_N;
    }
  }
}

TEST(ContactSpring, ReferenceProfileByHand) {
  const ContactSpring spring(test::scenario3().front(), 7000.0);
  const double solid = 1.0 / (1.0 / 17000.0 + 1.0 / 7000.0);
  const double soft = 1.0 / (1.0 / 1400.0 + 1.0 / solid);
  const double firm = 1.0 / (1.0 / 1800.0 + 1.0 / solid);
  const double first_m = 9.0 / soft;
  const double second_m = first_m + 7.0 / firm;
  EXPECT_NEAR(spring.force_N(0.5 * first_m), 4.5, 1e-12);
  EXPECT_NEAR(spring.force_N(0.5 * (first_m + second_m)), 12.5, 1e-12);
  EXPECT_NEAR(spring.force_N(second_m + 1e-3), 16.0 + solid * 1e-3, 1e-12);
}

}  // namespace
}  // namespace tactus
