#include "tactus/sim/obstacle.h"

#include <gtest/gtest.h>

#include <numbers>

#include "support/crops9.h"
#include "support/random.h"

namespace tactus {
namespace {

constexpr double kStiffness_N_per_m = 1000.0;

ObstacleConfig lineAt(double x_m, double y_m) { return test::band(x_m, y_m, kStiffness_N_per_m); }

/// Closest point of the (endless) axis to a vertical line, by ternary search over the axis.
struct Closest {
  double position_m, distance_m;
};

Closest closestByBruteForce(const CoverAxis& axis, double x_m, double y_m) {
  // A vertical line meets every height: only the horizontal distance counts.
  const auto distance = [&](double s) {
    const Vector3 p = axis.p_BaseStart + s * axis.direction;
    return std::hypot(p.x() - x_m, p.y() - y_m);
  };
  double low = -100.0;
  double high = 100.0;
  for (int i = 0; i < 300; ++i) {
    const double a = low + (high - low) / 3.0;
    const double b = high - (high - low) / 3.0;
    (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
  }
  return {low, distance(low)};
}

struct RandomMeeting {
  explicit RandomMeeting(test::Random& random)
      : axis{random.vector<Vector3>(3, -1.0, 1.0), random.unitVector(), random.uniform(0.1, 0.6),
             random.uniform(0.02, 0.1)},
        obstacle(lineAt(0.0, 0.0)) {
    const Vector3 near = axis.p_BaseStart + random.uniform(-0.1, 0.7) * axis.direction;
    obstacle.x_m = near.x() + random.uniform(-0.15, 0.15);
    obstacle.y_m = near.y() + random.uniform(-0.15, 0.15);
  }
  CoverAxis axis;
  ObstacleConfig obstacle;
};

TEST(Obstacle, TouchesWhereTheClosestPointLiesOnTheCover) {
  test::Random random(311);
  int touched = 0;
  for (int i = 0; i < 3000; ++i) {
    const RandomMeeting m(random);
    if (std::hypot(m.axis.direction.x(), m.axis.direction.y()) < 0.05) continue;
    const Closest closest = closestByBruteForce(m.axis, m.obstacle.x_m, m.obstacle.y_m);
    if (std::abs(closest.position_m) < 1e-4) continue;
    if (std::abs(closest.position_m - m.axis.length_m) < 1e-4) continue;
    const ObstacleContact contact = Obstacle(m.obstacle, kNoLimit).touch(m.axis, 0.0);
    const bool on_cover = closest.position_m > 0.0 && closest.position_m < m.axis.length_m;
    const double penetration_m = on_cover ? m.axis.radius_m - closest.distance_m : 0.0;
    ASSERT_NEAR(contact.force_N, kStiffness_N_per_m * std::max(0.0, penetration_m), 1e-4) << i;
    if (contact.force_N == 0.0) continue;
    ASSERT_NEAR(contact.position_m, closest.position_m, 1e-5) << i;
    ++touched;
  }
  EXPECT_GT(touched, 300);
}

TEST(Obstacle, PushesHorizontallyWithoutFrictionAndAway) {
  test::Random random(312);
  for (int i = 0; i < 3000; ++i) {
    const RandomMeeting m(random);
    const ObstacleContact contact = Obstacle(m.obstacle, kNoLimit).touch(m.axis, 0.0);
    if (contact.force_N == 0.0) continue;
    ASSERT_EQ(contact.force_Base.z(), 0.0);
    ASSERT_NEAR(contact.force_Base.norm(), contact.force_N, 1e-12 * contact.force_N);
    ASSERT_NEAR(contact.force_Base.dot(m.axis.direction), 0.0, 1e-12 * contact.force_N)
        << "no part along the axis: nothing to gain by sliding";
    const Vector3 point = m.axis.p_BaseStart + contact.position_m * m.axis.direction;
    const Vector3 from_line(point.x() - m.obstacle.x_m, point.y() - m.obstacle.y_m, 0.0);
    ASSERT_GT(contact.force_Base.dot(from_line), 0.0) << "pulls the cover in";
  }
}

CoverAxis alongX(double y_m) { return {Vector3(0.0, y_m, 0.5), Vector3::UnitX(), 0.4, 0.06}; }

TEST(Obstacle, PushesBackAnArmThatWentRightThroughIt) {
  for (const double side : {1.0, -1.0}) {
    Obstacle obstacle(lineAt(0.2, 0.1 * side), kNoLimit);
    double before_N = 0.0;
    for (double y_m = 0.0; y_m < 0.5; y_m += 0.01) {  // towards the obstacle and beyond
      const ObstacleContact contact = obstacle.touch(alongX(y_m * side), 0.0);
      ASSERT_NEAR(contact.force_N, kStiffness_N_per_m * std::max(0.0, y_m - 0.04), 1e-9);
      ASSERT_GE(contact.force_N, before_N);
      ASSERT_LE(contact.force_Base.y() * side, 0.0) << "the side has changed at " << y_m;
      before_N = contact.force_N;
    }
  }
}

TEST(Obstacle, AppearsAndVanishesInTime) {
  ObstacleConfig config = lineAt(0.2, 0.03);
  config.appears_s = 1.0;
  config.vanishes_s = 2.0;
  Obstacle obstacle(config, kNoLimit);
  EXPECT_EQ(obstacle.touch(alongX(0.0), 0.0).force_N, 0.0);
  EXPECT_EQ(obstacle.touch(alongX(0.0), 0.999).force_N, 0.0);
  EXPECT_NEAR(obstacle.touch(alongX(0.0), 1.0).force_N, 30.0, 1e-9);
  EXPECT_NEAR(obstacle.touch(alongX(0.0), 1.999).force_N, 30.0, 1e-9);
  EXPECT_EQ(obstacle.touch(alongX(0.0), 2.0).force_N, 0.0);
}

TEST(Obstacle, SwingsAroundItsPlace) {
  ObstacleConfig config = lineAt(0.2, 0.05);  // 10 mm in the cover
  config.appears_s = 1.0;
  config.swing = {0.03, -0.02, 0.25};
  Obstacle obstacle(config, kNoLimit);
  EXPECT_EQ(obstacle.touch(alongX(0.0), 0.0).force_N, 0.0);
  EXPECT_NEAR(obstacle.touch(alongX(0.0), 1.0).force_N, 10.0, 1e-9);
  const ObstacleContact quarter = obstacle.touch(alongX(0.0), 2.0);
  EXPECT_NEAR(quarter.force_N, 30.0, 1e-9);
  EXPECT_NEAR(quarter.position_m, 0.23, 1e-12);
  EXPECT_EQ(obstacle.touch(alongX(0.0), 4.0).force_N, 0.0);
  EXPECT_NEAR(obstacle.touch(alongX(0.0), 2.0 + 4.0 * 86400.0).force_N, 30.0, 1e-9) << "days later";
}

TEST(Obstacle, TakesItsSideWhenItAppears) {
  ObstacleConfig config = lineAt(0.2, 0.1);
  config.appears_s = 1.0;
  Obstacle obstacle(config, kNoLimit);
  obstacle.touch(alongX(0.0), 0.0);  // passes while it is not there yet
  const ObstacleContact contact = obstacle.touch(alongX(0.15), 1.0);
  EXPECT_NEAR(contact.force_N, 10.0, 1e-9);
  EXPECT_GT(contact.force_Base.y(), 0.0);
}

TEST(Obstacle, LeavesAVerticalLinkAlone) {
  Obstacle obstacle(lineAt(0.0, 0.0), kNoLimit);
  const CoverAxis vertical{Vector3(0.0, 0.01, 0.0), Vector3::UnitZ(), 0.4, 0.06};
  const ObstacleContact contact = obstacle.touch(vertical, 0.0);
  EXPECT_EQ(contact.force_N, 0.0);
}

TEST(Obstacle, TakesItsSideAnewWhenItComesBackOverTheEnd) {
  Obstacle obstacle(lineAt(0.5, 0.1), kNoLimit);  // beyond the end, left of the axis
  const auto axis = [](double y_m, double length_m) {
    return CoverAxis{Vector3(0.0, y_m, 0.0), Vector3::UnitX(), length_m, 0.06};
  };
  EXPECT_EQ(obstacle.touch(axis(0.0, 0.4), 0.0).force_N, 0.0);
  EXPECT_EQ(obstacle.touch(axis(0.3, 0.4), 0.0).force_N, 0.0) << "still beyond, now on the right";
  EXPECT_EQ(obstacle.touch(axis(0.3, 0.6), 0.0).force_N, 0.0) << "beside the cover, 0.2 m away";
}

/// A cover along x that is pressed against a line at its left, and has moved from another pose.
struct Rubbed {
  explicit Rubbed(const ObstacleConfig& config) : obstacle(config, kNoLimit) {}

  ObstacleFriction operator()(const Pose& X_before, const Pose& X, double t_s = 0.0) {
    const CoverAxis axis{X.p_AB, X.R_AB.col(0), 0.4, 0.06};
    return obstacle.rub({X, X_before}, axis, obstacle.touch(axis, t_s));
  }

  Obstacle obstacle;
};

ObstacleConfig roughLine() {
  ObstacleConfig config = lineAt(0.2, 0.05);  // 10 N
  config.friction_coefficient = 0.3;
  config.shear_stiffness_N_per_m = 5000.0;
  return config;
}

Pose at(double x_m, double y_m, double z_m, double roll_rad = 0.0) {
  Pose X;
  X.p_AB = Vector3(x_m, y_m, z_m);
  X.R_AB = Eigen::AngleAxisd(roll_rad, Vector3::UnitX()).toRotationMatrix();
  return X;
}

TEST(Obstacle, RubsAgainstTheMotionOfTheMaterialWhereTheyTouch) {
  const auto friction = [](const Pose& X) { return Rubbed(roughLine())(at(0, 0, 0), X); };
  const ObstacleFriction along = friction(at(1e-4, 0, 0));
  EXPECT_LT((along.force_Base - Vector3(-0.5, 0, 0)).norm(), 1e-9);
  EXPECT_LT((along.p_ModuleSurface - Vector3(0.2 - 1e-4, 0.06, 0)).norm(), 1e-12);
  EXPECT_LT((friction(at(0, 0, -2e-4)).force_Base - Vector3(0, 0, 1.0)).norm(), 1e-9);
  EXPECT_LT(friction(at(0, 1e-3, 0)).force_Base.norm(), 1e-9) << "into it";
  // Rolling about its own axis moves the material, though neither axis nor place of contact.
  const Vector3 rolled = friction(at(0, 0, 0, 1e-3)).force_Base;
  EXPECT_LT((rolled - Vector3(0, 0, -5000.0 * 0.06e-3)).norm(), 1e-6);
  EXPECT_NEAR(friction(at(0.1, 0, 0.1)).force_Base.norm(), 0.3 * 10.0, 1e-9) << "it slips";
  EXPECT_FALSE(Obstacle(lineAt(0.2, 0.05), kNoLimit).hasFriction());
}

TEST(Obstacle, DoesNotRubOnAnArmThatMovesWithIt) {
  ObstacleConfig config = roughLine();
  config.swing = {0.03, 0.0, 0.25};
  Rubbed rubbed(config);
  rubbed(at(0, 0, 0), at(0, 0, 0), 0.0);
  const double way_m = 0.03 * std::sin(2.0 * std::numbers::pi * 0.25 * 0.1);
  EXPECT_LT(rubbed(at(0, 0, 0), at(way_m, 0, 0), 0.1).force_Base.norm(), 1e-9);
}

TEST(Obstacle, ForgetsHowItRubbedWhereItLetsGo) {
  Rubbed rubbed(roughLine());
  EXPECT_GT(rubbed(at(0, 0, 0), at(1e-4, 0, 0)).force_Base.norm(), 0.1);
  EXPECT_EQ(rubbed(at(1e-4, 0, 0), at(0, -0.1, 0)).force_Base.norm(), 0.0);
  EXPECT_EQ(rubbed(at(0, 0, 0), at(0, 0, 0)).force_Base.norm(), 0.0);
}

}  // namespace
}  // namespace tactus
