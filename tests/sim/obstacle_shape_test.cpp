#include "tactus/sim/obstacle_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/allocation_guard.h"
#include "support/crops9.h"
#include "support/random.h"
#include "tactus/sim/obstacle.h"

namespace tactus {
namespace {

constexpr double kSpring_N_per_m = 1000.0;
constexpr double kCoverRadius_m = 0.06;

ObstacleConfig spring() {
  ObstacleConfig config;
  config.stiffness_N_per_m = kSpring_N_per_m;
  return config;
}

ObstacleConfig sphere(const Vector3& center_m, double radius_m) {
  ObstacleConfig config = spring();
  config.sphere = SphereConfig{center_m, radius_m};
  return config;
}

ObstacleConfig plane(const Vector3& point_m, const Vector3& normal) {
  ObstacleConfig config = spring();
  config.plane = PlaneConfig{point_m, normal};
  return config;
}

ObstacleConfig line(const Vector3& point_m, const Vector3& direction) {
  ObstacleConfig config = spring();
  config.line = LineConfig{point_m, direction};
  return config;
}

ObstacleConfig post(const Vector3& foot_m, const Vector3& axis, double height_m, double radius_m) {
  ObstacleConfig config = spring();
  config.post = PostConfig{foot_m, axis, height_m, radius_m};
  return config;
}

CoverAxis levelAxis(double y_m, double z_m = 0.5) {
  return {Vector3(0.0, y_m, z_m), Vector3::UnitX(), 0.4, kCoverRadius_m};
}

void expectForce(const ObstacleConfig& config, const CoverAxis& axis, const Vector3& force_Base,
                 double position_m) {
  const ObstacleContact contact = Obstacle(config, kNoLimit).touch(axis, 0.0);
  EXPECT_LT((contact.force_Base - force_Base).norm(), 1e-9) << contact.force_Base.transpose();
  EXPECT_NEAR(contact.force_N, force_Base.norm(), 1e-9);
  EXPECT_NEAR(contact.position_m, position_m, 1e-12);
}

TEST(ObstacleShape, ByHand) {
  expectForce(sphere({0.1, 0.0, 0.3}, 0.15), levelAxis(0.0), Vector3(0, 0, 10), 0.1);
  expectForce(sphere({0.5, 0.0, 0.5}, 0.05), levelAxis(0.0), Vector3(-10, 0, 0), 0.4);
  expectForce(plane({3, 4, 0.45}, {0, 0, 9}), levelAxis(0.0), Vector3(0, 0, 10), 0.2);
  expectForce(plane({3, 0.05, 4}, {0, -1, 0}), levelAxis(0.0), Vector3(0, -10, 0), 0.2);
  const CoverAxis tilted{Vector3(0, 0, 0.5), Vector3(0.6, 0, -0.8), 0.4, kCoverRadius_m};
  expectForce(plane({0, 0, 0.15}, {0, 0, 1}), tilted, Vector3(0, 0, 30), 0.4);
  expectForce(line({9, 0, 0.55}, {2, 0, 0}), levelAxis(0.0), Vector3(0, 0, -10), 0.2);
  expectForce(line({0.3, 7, 0.45}, {0, 1, 0}), levelAxis(0.0), Vector3(0, 0, 10), 0.3);
  expectForce(post({0.3, 0.07, 0}, {0, 0, 1}, 1.0, 0.02), levelAxis(0.0), Vector3(0, -10, 0), 0.3);
  expectForce(post({0.3, 0.0, 0}, {0, 0, 2}, 0.4, 0.05), levelAxis(0.0), Vector3(0, 0, 10), 0.3);
  expectForce(post({0.3, 0.0, 0}, {0, 0, 1}, 0.3, 0.05), levelAxis(0.0), Vector3::Zero(), 0.3);
}

/// An arm that goes straight through a thin obstacle: pushed back all the way.
TEST(ObstacleShape, PushesBackAnArmThatWentRightThroughIt) {
  const ObstacleConfig shapes[] = {line({0.2, 0.1, 0.0}, {0.3, 0.0, 1.0}),
                                   post({0.2, 0.1, 0.0}, {0, 0, 1}, 1.0, 0.0),
                                   sphere({0.2, 0.1, 0.5}, 0.005)};
  for (const ObstacleConfig& config : shapes) {
    Obstacle obstacle(config, kNoLimit);
    double before_N = 0.0;
    for (double y_m = 0.0; y_m < 0.4; y_m += 0.003) {
      const ObstacleContact contact = obstacle.touch(levelAxis(y_m), 0.0);
      ASSERT_GE(contact.force_N, before_N) << y_m;
      ASSERT_LE(contact.force_Base.y(), 0.0) << "the side has changed at " << y_m;
      before_N = contact.force_N;
    }
    EXPECT_GT(before_N, 250.0);
    EXPECT_EQ(obstacle.touch(levelAxis(-2.0), 0.0).force_N, 0.0) << "back where it came from";
  }
}

TEST(ObstacleShape, TakesItsSideAnewWhenItComesBackOverTheEnd) {
  Obstacle obstacle(post({0.2, 0.1, 0.0}, {0, 0, 1}, 1.0, 0.0), kNoLimit);
  EXPECT_EQ(obstacle.touch(levelAxis(0.0), 0.0).force_N, 0.0);
  EXPECT_EQ(obstacle.touch(levelAxis(0.0, 1.2), 0.0).force_N, 0.0) << "above it";
  EXPECT_EQ(obstacle.touch(levelAxis(0.2, 1.2), 0.0).force_N, 0.0);
  EXPECT_EQ(obstacle.touch(levelAxis(0.2), 0.0).force_N, 0.0) << "on the other side, 0.1 m away";
}

TEST(ObstacleShape, VerticalPostIsTheVerticalLine) {
  test::Random random(921);
  int touched = 0;
  for (int i = 0; i < 4000; ++i) {
    const CoverAxis axis{random.vector<Vector3>(3, -1.0, 1.0), random.unitVector(),
                         random.uniform(0.1, 0.6), kCoverRadius_m};
    const Vector3 near =
        axis.p_BaseStart + random.uniform(0.02, 0.98) * axis.length_m * axis.direction;
    const double x_m = near.x() + random.uniform(-0.07, 0.07);
    const double y_m = near.y() + random.uniform(-0.07, 0.07);
    const ObstacleContact expected =
        Obstacle(test::band(x_m, y_m, kSpring_N_per_m), kNoLimit).touch(axis, 0.0);
    if (expected.force_N == 0.0) continue;
    for (const ObstacleConfig& config :
         {post({x_m, y_m, -9.0}, {0, 0, 1}, 18.0, 0.0), line({x_m, y_m, 3.0}, {0, 0, -2})}) {
      const ObstacleContact contact = Obstacle(config, kNoLimit).touch(axis, 0.0);
      ASSERT_LT((contact.force_Base - expected.force_Base).norm(), 1e-7) << i;
      ASSERT_NEAR(contact.position_m, expected.position_m, 1e-7) << i;
    }
    ++touched;
  }
  EXPECT_GT(touched, 1000);
}

ObstacleConfig randomShape(test::Random& random, int kind, const Vector3& near) {
  const Vector3 direction = random.uniform(0.1, 5.0) * random.unitVector();
  ObstacleConfig config =
      kind == 0   ? sphere(near, random.uniform(0.01, 0.2))
      : kind == 1 ? plane(near, direction)
      : kind == 2 ? line(near, direction)
                  : post(near, direction, random.uniform(0.01, 0.5), random.uniform(0.0, 0.1));
  if (random.chance(0.5)) config.foam = {{300.0, 2.0}, {600.0, 8.0}};
  return config;
}

CoverAxis moved(const CoverAxis& axis, const Vector3& way_m, const Vector3& turn_rad) {
  const double angle = turn_rad.norm();
  const Matrix3 R =
      angle == 0.0 ? Matrix3::Identity() : Matrix3(Eigen::AngleAxisd(angle, turn_rad / angle));
  return {R * axis.p_BaseStart + way_m, R * axis.direction, axis.length_m, axis.radius_m};
}

/// What it takes to press the spring so far: the integral of its force, by Simpson's rule, which is
/// exact between the ends of its layers.
double energy_J(const ObstacleConfig& config, double force_N) {
  double energy = 0.0;
  double from_N = 0.0;
  for (FoamLayer layer : config.foam) {
    const double k = inSeries(layer.stiffness_N_per_m, config.stiffness_N_per_m);
    const double to_N = std::min(force_N, layer.until_force_N);
    if (to_N > from_N) energy += 0.5 * (to_N * to_N - from_N * from_N) / k;
    from_N = std::max(from_N, to_N);
  }
  if (force_N > from_N)
    energy += 0.5 * (force_N * force_N - from_N * from_N) / config.stiffness_N_per_m;
  return energy;
}

TEST(ObstacleShape, PushesDownTheSlopeOfAnEnergy) {
  test::Random random(922);
  int touched = 0;
  for (int i = 0; i < 6000; ++i) {
    const CoverAxis axis{random.vector<Vector3>(3, -0.5, 0.5), random.unitVector(),
                         random.chance(0.1) ? 0.0 : random.uniform(0.1, 0.6), kCoverRadius_m};
    const ObstacleConfig config =
        randomShape(random, i % 4, axis.p_BaseStart + random.vector<Vector3>(3, -0.2, 0.4));
    const ObstacleContact contact = Obstacle(config, kNoLimit).touch(axis, 0.0);
    if (contact.force_N < 1.0) continue;
    const auto energyAt = [&](const Vector3& way_m, const Vector3& turn_rad) {
      return energy_J(config,
                      Obstacle(config, kNoLimit).touch(moved(axis, way_m, turn_rad), 0.0).force_N);
    };
    const Vector3 moment =
        (axis.p_BaseStart + contact.position_m * axis.direction).cross(contact.force_Base);
    const Vector3 way = random.unitVector();
    constexpr double kStep = 1e-6;
    const Vector3 zero = Vector3::Zero();
    const double slope =
        (energyAt(kStep * way, zero) - energyAt(-kStep * way, zero)) / (2.0 * kStep);
    const double slope_of_turn =
        (energyAt(zero, kStep * way) - energyAt(zero, -kStep * way)) / (2.0 * kStep);
    // Where a layer of foam ends the slope of the force changes, not the force.
    ASSERT_NEAR(contact.force_Base.dot(way), -slope, 2e-3 + 1e-4 * contact.force_N) << i;
    ASSERT_NEAR(moment.dot(way), -slope_of_turn, 2e-3 + 1e-4 * contact.force_N) << i;
    ++touched;
  }
  EXPECT_GT(touched, 800);
}

TEST(ObstacleShape, IsFiniteWhereverTheyMeetAndUsesNoHeap) {
  test::Random random(923);
  for (int i = 0; i < 4000; ++i) {
    const CoverAxis axis{random.vector<Vector3>(3, -0.5, 0.5), random.unitVector(),
                         random.chance(0.2) ? 0.0 : random.uniform(0.1, 0.6), kCoverRadius_m};
    const Vector3 near =
        random.chance(0.5) ? axis.p_BaseStart : Vector3(axis.p_BaseStart + 0.1 * axis.direction);
    ObstacleConfig config = randomShape(random, i % 4, near);
    if (random.chance(0.3)) config.line = LineConfig{near, axis.direction};
    config.friction_coefficient = 0.4;
    config.swing = {0.01, 0.02, 3.0, 0.03};
    Obstacle obstacle(config, 7000.0);
    Pose before;
    before.p_AB = axis.p_BaseStart;
    for (int step = 0; step < 3; ++step) {
      test::AllocationGuard guard;
      const ObstacleContact contact = obstacle.touch(axis, 0.001 * step);
      const ObstacleFriction friction = obstacle.rub({before, before}, axis, contact);
      ASSERT_TRUE(contact.force_Base.allFinite() && std::isfinite(contact.position_m));
      ASSERT_TRUE(friction.force_Base.allFinite() && friction.p_ModuleSurface.allFinite());
    }
  }
}

TEST(ObstacleShape, SwingsInAllDirections) {
  ObstacleConfig config = plane({0, 0, 0.45}, {0, 0, 1});
  config.swing = {0.5, 0.5, 0.25, 0.02};
  Obstacle floor(config, kNoLimit);
  EXPECT_NEAR(floor.touch(levelAxis(0.0), 0.0).force_N, 10.0, 1e-9);
  EXPECT_NEAR(floor.touch(levelAxis(0.0), 1.0).force_N, 30.0, 1e-9);
  EXPECT_EQ(floor.touch(levelAxis(0.0), 3.0).force_N, 0.0);
}

TEST(ObstacleShape, RubsAcrossItsNormalInTheMaterialsDirection) {
  ObstacleConfig config = plane({0, 0, 0.45}, {0, 0, 1});
  config.friction_coefficient = 0.3;
  config.shear_stiffness_N_per_m = 5000.0;
  const auto friction = [&](const Vector3& way_m) {
    Obstacle obstacle(config, kNoLimit);
    Pose X, X_before;
    X.p_AB = Vector3(0.0, 0.0, 0.5);
    X_before.p_AB = X.p_AB - way_m;
    return obstacle.rub({X, X_before}, levelAxis(0.0), obstacle.touch(levelAxis(0.0), 0.0));
  };
  EXPECT_LT((friction({1e-4, 0, 0}).force_Base - Vector3(-0.5, 0, 0)).norm(), 1e-9);
  EXPECT_LT((friction({0, -2e-4, 0}).force_Base - Vector3(0, 1, 0)).norm(), 1e-9);
  EXPECT_LT(friction({0, 0, 1e-3}).force_Base.norm(), 1e-9) << "out of it";
  EXPECT_NEAR(friction({0.3, 0.4, 0}).force_Base.norm(), 3.0, 1e-9) << "it slips";
  EXPECT_LT((friction({0, 0, 0}).p_ModuleSurface - Vector3(0.2, 0, -0.06)).norm(), 1e-12);
}

}  // namespace
}  // namespace tactus
