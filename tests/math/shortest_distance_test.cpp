#include "tactus/math/shortest_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "support/random.h"

namespace tactus {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

/// The smallest value of a convex function of one number, by ternary search.
double smallest(double low, double high, const std::function<double(double)>& value) {
  for (int i = 0; i < 80; ++i) {
    const double a = low + (high - low) / 3.0;
    const double b = high - (high - low) / 3.0;
    (value(a) < value(b) ? high : low) = value(a) < value(b) ? b : a;
  }
  return value(0.5 * (low + high));
}

Vector3 at(const Segment& segment, double s) { return segment.p_Start + s * segment.direction; }

double bruteForce(const Segment& segment, const Vector3& point) {
  return smallest(0.0, segment.length_m, [&](double s) { return (at(segment, s) - point).norm(); });
}

double bruteForce(const Segment& segment, const Straight& straight) {
  const double from = std::max(straight.from_m, -30.0);
  const double to = std::min(straight.to_m, 30.0);
  return smallest(0.0, segment.length_m, [&](double s) {
    return smallest(from, to, [&](double t) {
      return (at(segment, s) - straight.p - t * straight.direction).norm();
    });
  });
}

double bruteForce(const Segment& segment, const HalfSpace& half_space) {
  return smallest(0.0, segment.length_m, [&](double s) {
    return half_space.normal.dot(at(segment, s) - half_space.p_Surface);
  });
}

Segment randomSegment(test::Random& random) {
  return {random.vector<Vector3>(3, -1.0, 1.0), random.unitVector(),
          random.chance(0.1) ? 0.0 : random.logUniform(0.01, 2.0)};
}

/// Now and then parallel to the segment, or nearly, and through it.
Straight randomStraight(test::Random& random, const Segment& segment) {
  Straight straight{random.vector<Vector3>(3, -1.0, 1.0), random.unitVector(), 0.0,
                    random.logUniform(0.01, 2.0)};
  if (random.chance(0.2)) straight.direction = random.sign() * segment.direction;
  if (random.chance(0.1)) {
    straight.direction =
        (segment.direction + random.logUniform(1e-12, 1e-3) * random.unitVector()).normalized();
  }
  if (random.chance(0.1)) straight.p = at(segment, random.uniform(-0.5, 1.0));
  if (random.chance(0.3)) straight.to_m = kEndless;
  if (random.chance(0.2)) straight.from_m = -kEndless;
  return straight;
}

HalfSpace randomHalfSpace(test::Random& random) {
  return {random.vector<Vector3>(3, -1.0, 1.0), random.unitVector()};
}

/// What holds of any pair of nearest points.
void expectSound(const Segment& segment, const ClosestPoints& closest, int i) {
  ASSERT_GE(closest.position_m, 0.0) << i;
  ASSERT_LE(closest.position_m, segment.length_m) << i;
  ASSERT_LT((closest.p_Segment - at(segment, closest.position_m)).norm(), 1e-15) << i;
  ASSERT_NEAR(closest.normal.norm(), 1.0, 1e-12) << i;
  if (!closest.is_beside) return;
  ASSERT_NEAR(closest.normal.dot(segment.direction), 0.0, 1e-6 / std::max(closest.distance_m, 1e-3))
      << i;
}

TEST(ShortestDistance, IsTheSmallestOfAllPairsOfPoints) {
  test::Random random(901);
  for (int i = 0; i < 1500; ++i) {
    const Segment segment = randomSegment(random);
    const Vector3 point = random.vector<Vector3>(3, -1.0, 1.0);
    const Straight straight = randomStraight(random, segment);
    const HalfSpace half_space = randomHalfSpace(random);
    const ClosestPoints to_point = closestPoints(segment, point);
    const ClosestPoints to_straight = closestPoints(segment, straight);
    const ClosestPoints to_half_space = closestPoints(segment, half_space);
    ASSERT_NEAR(to_point.distance_m, bruteForce(segment, point), 1e-9) << i;
    ASSERT_NEAR(to_straight.distance_m, bruteForce(segment, straight), 2e-8) << i;
    ASSERT_NEAR(to_half_space.distance_m, bruteForce(segment, half_space), 1e-9) << i;
    expectSound(segment, to_point, i);
    expectSound(segment, to_straight, i);
    expectSound(segment, to_half_space, i);
  }
}

TEST(ShortestDistance, NormalLeadsFromTheOtherShapeToTheSegment) {
  test::Random random(902);
  for (int i = 0; i < 1500; ++i) {
    const Segment segment = randomSegment(random);
    const Vector3 point = random.vector<Vector3>(3, -1.0, 1.0);
    const ClosestPoints to_point = closestPoints(segment, point);
    ASSERT_LT((to_point.p_Segment - to_point.distance_m * to_point.normal - point).norm(), 1e-12);
    const Straight straight = randomStraight(random, segment);
    const ClosestPoints closest = closestPoints(segment, straight);
    const Vector3 p_Straight = closest.p_Segment - closest.distance_m * closest.normal;
    const double t = straight.direction.dot(p_Straight - straight.p);
    ASSERT_LT((p_Straight - straight.p - t * straight.direction).norm(), 2e-9)
        << "not on it, " << i;
    ASSERT_GT(t, straight.from_m - 2e-9) << i;
    ASSERT_LT(t, straight.to_m + 2e-9) << i;
  }
}

/// Central difference of a distance over a shift of the segment along `way`.
template <typename Shape>
double slope(Segment segment, const Shape& shape, const Vector3& way) {
  constexpr double kStep_m = 1e-6;
  segment.p_Start += kStep_m * way;
  const double after = closestPoints(segment, shape).distance_m;
  segment.p_Start -= 2.0 * kStep_m * way;
  return (after - closestPoints(segment, shape).distance_m) / (2.0 * kStep_m);
}

/// The same over a turn of the segment about `axis` through the origin, rad.
template <typename Shape>
double slopeOfTurn(const Segment& segment, const Shape& shape, const Vector3& axis) {
  constexpr double kStep_rad = 1e-6;
  const auto turned = [&](double angle) {
    const Matrix3 R = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    return closestPoints({R * segment.p_Start, R * segment.direction, segment.length_m}, shape)
        .distance_m;
  };
  return (turned(kStep_rad) - turned(-kStep_rad)) / (2.0 * kStep_rad);
}

template <typename Shape>
void expectGradient(const Segment& segment, const Shape& shape, const Vector3& way, int i) {
  const ClosestPoints closest = closestPoints(segment, shape);
  ASSERT_NEAR(closest.normal.dot(way), slope(segment, shape, way), 2e-5) << i;
  ASSERT_NEAR(closest.p_Segment.cross(closest.normal).dot(way), slopeOfTurn(segment, shape, way),
              5e-5)
      << i;
}

TEST(ShortestDistance, NormalIsItsGradient) {
  test::Random random(903);
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const Segment segment = randomSegment(random);
    const Vector3 way = random.unitVector();
    const Vector3 point = random.vector<Vector3>(3, -1.0, 1.0);
    Straight straight{random.vector<Vector3>(3, -1.0, 1.0), random.unitVector(), -kEndless,
                      random.chance(0.5) ? kEndless : 0.3};
    // Near parallels the nearest point runs, and at a distance of 0 there is no gradient.
    if (segment.direction.cross(straight.direction).norm() < 0.05) continue;
    if (closestPoints(segment, point).distance_m < 0.02) continue;
    if (closestPoints(segment, straight).distance_m < 0.02) continue;
    expectGradient(segment, point, way, i);
    expectGradient(segment, straight, way, i);
    HalfSpace half_space = randomHalfSpace(random);
    if (std::abs(half_space.normal.dot(segment.direction)) > 1e-3)
      expectGradient(segment, half_space, way, i);
    ++compared;
  }
  EXPECT_GT(compared, 2000);
}

constexpr double kLength_m = 0.4;
const Segment kAlongX{Vector3(0.0, 0.0, 0.5), Vector3::UnitX(), kLength_m};

TEST(ShortestDistance, ByHand) {
  const ClosestPoints beside = closestPoints(kAlongX, Vector3(0.1, 0.3, 0.9));
  EXPECT_NEAR(beside.distance_m, 0.5, 1e-15);
  EXPECT_NEAR(beside.position_m, 0.1, 1e-15);
  EXPECT_LT((beside.normal - Vector3(0.0, -0.6, -0.8)).norm(), 1e-14);
  EXPECT_TRUE(beside.is_beside);
  const ClosestPoints beyond = closestPoints(kAlongX, Vector3(0.7, 0.0, 0.9));
  EXPECT_NEAR(beyond.distance_m, 0.5, 1e-15);
  EXPECT_LT((beyond.normal - Vector3(-0.6, 0.0, -0.8)).norm(), 1e-14);
  EXPECT_FALSE(beyond.is_beside);
  const Straight post{Vector3(0.1, 0.2, 0.0), Vector3::UnitZ(), 0.0, 0.3};
  const ClosestPoints over_post = closestPoints(kAlongX, post);
  EXPECT_NEAR(over_post.distance_m, std::sqrt(0.08), 1e-15);
  EXPECT_FALSE(over_post.is_beside);
  const ClosestPoints tilted = closestPoints({Vector3(0.0, 0.0, 0.5), Vector3(0.6, 0.0, -0.8), 1.0},
                                             HalfSpace{Vector3(7.0, 8.0, 0.1), Vector3::UnitZ()});
  EXPECT_EQ(tilted.position_m, 1.0);
  EXPECT_NEAR(tilted.distance_m, -0.4, 1e-15);
}

TEST(ShortestDistance, TakesTheMiddleOfParallels) {
  const Vector3 p(0.3, 0.2, 0.5);
  for (const double sign : {1.0, -1.0}) {
    const Vector3 along = sign * Vector3::UnitX();
    EXPECT_NEAR(closestPoints(kAlongX, Straight{p, along, -kEndless, kEndless}).position_m, 0.2,
                1e-15);
    const double from = sign > 0.0 ? 0.0 : -kEndless;
    const double to = sign > 0.0 ? kEndless : 0.0;
    EXPECT_NEAR(closestPoints(kAlongX, Straight{p, along, from, to}).position_m, 0.35, 1e-15);
    EXPECT_NEAR(closestPoints(kAlongX, Straight{p, along, from, to}).distance_m, 0.2, 1e-15);
  }
  const HalfSpace floor{Vector3::Zero(), Vector3::UnitZ()};
  EXPECT_EQ(closestPoints(kAlongX, floor).position_m, 0.2);
  EXPECT_EQ(closestPoints(kAlongX, floor).distance_m, 0.5);
}

TEST(ShortestDistance, HasANormalWhereShapesMeet) {
  const Vector3 inside(0.1, 0.0, 0.5);
  const ClosestPoints point = closestPoints(kAlongX, inside);
  EXPECT_EQ(point.distance_m, 0.0);
  EXPECT_NEAR(point.normal.dot(Vector3::UnitX()), 0.0, 1e-15);
  const ClosestPoints crossing =
      closestPoints(kAlongX, Straight{inside, Vector3::UnitZ(), -kEndless, kEndless});
  EXPECT_NEAR(std::abs(crossing.normal.y()), 1.0, 1e-15);
  const ClosestPoints same =
      closestPoints(kAlongX, Straight{inside, Vector3::UnitX(), -kEndless, kEndless});
  EXPECT_NEAR(same.normal.norm(), 1.0, 1e-15);
  EXPECT_NEAR(same.normal.x(), 0.0, 1e-15);
}

}  // namespace
}  // namespace tactus
