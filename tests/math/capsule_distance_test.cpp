#include <fcl/geometry/shape/capsule.h>
#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include "support/random.h"
#include "tactus/math/shortest_distance.h"

/// Distances of capsules against those of FCL, which has a closed form of its own for them.
namespace tactus {
namespace {

struct TwoCapsules {
  Segment a, b;
  double radius_a_m, radius_b_m;
};

Segment segmentOf(test::Random& random, const Vector3& direction) {
  const double length_m = random.chance(0.1) ? 0.0 : random.logUniform(1e-3, 2.0);
  return {random.vector<Vector3>(3, -1.0, 1.0), direction, length_m};
}

/// Of any direction, parallel, nearly so, crossing, in one plane, and of one line.
TwoCapsules drawnCapsules(test::Random& random) {
  const Vector3 direction = random.unitVector();
  TwoCapsules two{segmentOf(random, direction), segmentOf(random, random.unitVector()),
                  random.logUniform(1e-3, 0.3), random.logUniform(1e-3, 0.3)};
  switch (random.index(6)) {
    case 0:
      two.b.direction = random.sign() * direction;
      break;
    case 1:
      two.b.direction =
          (direction + random.logUniform(1e-12, 1e-2) * random.unitVector()).normalized();
      break;
    case 2:
      two.b.p_Start = two.a.p_Start + random.uniform(0.0, two.a.length_m) * direction -
                      random.uniform(0.0, two.b.length_m) * two.b.direction;
      break;
    case 3:
      two.b.direction = (two.b.direction - direction.dot(two.b.direction) * direction).normalized();
      break;
    case 4:
      two.b.direction = random.sign() * direction;
      two.b.p_Start = two.a.p_Start + random.uniform(-2.0, 2.0) * direction;
      break;
    default:
      break;
  }
  return two;
}

fcl::Transform3d poseOf(const Segment& segment) {
  fcl::Transform3d X = fcl::Transform3d::Identity();
  X.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), segment.direction).matrix();
  X.translation() = segment.p_Start + 0.5 * segment.length_m * segment.direction;
  return X;
}

/// FCL loses half of its digits of lines that are almost parallel.
double toleranceOfFcl(const TwoCapsules& two) {
  const double sine = two.a.direction.cross(two.b.direction).norm();
  return sine > 0.0 && sine < 1e-5 ? 1e-7 : 1e-9;
}

/// FCL's distance; of capsules that overlap < 0.
double distanceOfFcl(const TwoCapsules& two) {
  const fcl::Capsuled a(two.radius_a_m, two.a.length_m);
  const fcl::Capsuled b(two.radius_b_m, two.b.length_m);
  const fcl::CollisionObjectd object_a(std::make_shared<fcl::Capsuled>(a), poseOf(two.a));
  const fcl::CollisionObjectd object_b(std::make_shared<fcl::Capsuled>(b), poseOf(two.b));
  fcl::DistanceRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::DistanceResultd result;
  return fcl::distance(&object_a, &object_b, request, result);
}

/// Both are distances of two points, so the smaller one is nearer to the truth.
TEST(CapsuleDistance, IsThatOfFcl) {
  test::Random random(431);
  int apart = 0, overlapping = 0;
  for (int i = 0; i < 120000; ++i) {
    const TwoCapsules two = drawnCapsules(random);
    const Straight b{two.b.p_Start, two.b.direction, 0.0, two.b.length_m};
    const double ours = closestPoints(two.a, b).distance_m - two.radius_a_m - two.radius_b_m;
    const double theirs = distanceOfFcl(two);
    if (ours > 0.0) {
      ASSERT_LE(ours, theirs + 1e-9) << i;
      ASSERT_LE(theirs, ours + toleranceOfFcl(two)) << i;
      ++apart;
    } else {
      ASSERT_LE(theirs, 1e-9) << i;
      ++overlapping;
    }
  }
  EXPECT_GT(apart, 60000);
  EXPECT_GT(overlapping, 5000);
}

}  // namespace
}  // namespace tactus
