#include "tactus/control/body_distances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "support/random_clearance.h"

namespace tactus {
namespace {

struct BodiesCase {
  explicit BodiesCase(test::Random& random)
      : n(random.integer(2, kMaxJoints)),
        chain(test::randomChain(random, n)),
        config(test::randomBodies(random, n)),
        distances(chain, config),
        q(random.vector(n, -2.0, 2.0)) {
    chain.computePose(q, pose);
  }
  double distanceAt(const JointVector& q_other, int index) const {
    ChainPose other;
    chain.computePose(q_other, other);
    return distances.distance_m(other, index);
  }

  int n;
  SerialChain chain;
  ClearanceConfig config;
  BodyDistances distances;
  JointVector q;
  ChainPose pose;
};

/// A wall has a body for each end of a capsule.
TEST(BodyDistances, FindEachThatIsNearerThanItsReach) {
  test::Random random(401);
  int found = 0, cut = 0;
  for (int i = 0; i < 2000; ++i) {
    const BodiesCase c(random);
    const double reach_m = random.logUniform(0.01, 3.0);
    NearBodies near;
    c.distances.findNear(c.pose, reach_m, near);
    std::vector<double> told(c.distances.size(), kNoLimit);
    for (int k = 0; k < near.size; ++k) {
      const NearBody& body = near.body[k];
      told[body.index] = std::min(told[body.index], body.distance_m);
      ASSERT_LE(body.distance_m, reach_m);
    }
    for (int index = 0; index < c.distances.size(); ++index) {
      const double distance_m = c.distances.distance_m(c.pose, index);
      if (told[index] < kNoLimit) {
        ASSERT_NEAR(told[index], distance_m, 1e-12) << i;
        ++found;
      } else {
        ASSERT_GE(distance_m, near.beyond_m - 1e-12) << i;
        cut += distance_m < reach_m ? 1 : 0;
        if (near.size < kMaxNearBodies) {
          ASSERT_GT(distance_m, reach_m) << i;
        }
      }
    }
  }
  EXPECT_GT(found, 5000);
  EXPECT_GT(cut, 5000);
}

/// Bars that are longer than they are apart touch at an end, far from their middles.
TEST(BodyDistances, FindTheEndsOfLongBars) {
  const SerialChain chain(std::vector<Joint>(2), {1, {}});
  ClearanceConfig config;
  for (const int joint : {1, -1}) {
    LinkCapsule& bar = config.capsules.emplace_back();
    bar.link.joint = joint;
    bar.p_LinkTo = 3.0 * Vector3::UnitX();
    bar.radius_m = 0.01;
  }
  config.capsules[1].link.X_JointFrame.p_AB = Vector3(3.1, 0.0, 0.0);
  config.pairs = {{0, 1}};
  const BodyDistances distances(chain, config);
  ChainPose pose;
  chain.computePose(JointVector::Zero(2), pose);
  NearBodies near;
  distances.findNear(pose, 0.1, near);
  ASSERT_EQ(near.size, 1);
  EXPECT_NEAR(near.body[0].distance_m, 0.08, 1e-12);
}

/// Where the nearest points jump, as of parallels, there is no gradient: such cases show in that
/// the differences to both sides differ.
TEST(BodyDistances, HaveTheGradientOfFiniteDifferences) {
  test::Random random(402);
  constexpr double kStep = 1e-6;
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const BodiesCase c(random);
    NearBodies near;
    c.distances.findNear(c.pose, 0.5, near);
    const int pairs = static_cast<int>(c.config.pairs.size());
    for (int k = 0; k < near.size; ++k) {
      const NearBody& body = near.body[k];
      const double distance_m = c.distances.distance_m(c.pose, body.index);
      if (body.index >= pairs && body.distance_m > distance_m + 1e-9) continue;  // other end
      if (body.distance_m < 0.0 && body.index < pairs) continue;  // across axes that may meet
      const JointVector way = random.vector(c.n, -1.0, 1.0);
      const double ahead_m = c.distanceAt(c.q + kStep * way, body.index);
      const double behind_m = c.distanceAt(c.q - kStep * way, body.index);
      const double forward = (ahead_m - distance_m) / kStep;
      const double backward = (distance_m - behind_m) / kStep;
      if (std::abs(forward - backward) > 1e-3) continue;
      ++compared;
      ASSERT_NEAR(0.5 * (forward + backward), c.distances.gradient(c.pose, body).head(c.n).dot(way),
                  1e-4)
          << i;
    }
  }
  EXPECT_GT(compared, 10000);
}

TEST(BodyDistances, BoundFromBelowWhatAMotionLeaves) {
  test::Random random(403);
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const BodiesCase c(random);
    NearBodies near;
    c.distances.findNear(c.pose, 0.5, near);
    const double size = random.logUniform(1e-5, 1e-3);
    const JointVector way = random.vector(c.n, -size, size);
    double bend_m = 0.0;  // coarse: 16 joints, none of whose points is 16 m away
    for (int j = 0; j < c.n; ++j) bend_m += std::abs(way[j]);
    bend_m *= 16.0 * bend_m;
    for (int k = 0; k < near.size; ++k) {
      const NearBody& body = near.body[k];
      if (body.distance_m < 0.0) continue;
      ASSERT_GE(c.distanceAt(c.q + way, body.index),
                c.distances.leftAfter_m(c.pose, body, 1.0, way) - bend_m)
          << i;
      const double left_m = c.distances.leftAfter_m(c.pose, body, 0.0, way);
      ASSERT_NEAR(left_m, c.distances.distance_m(c.pose, body.index), 1e-12) << i;
      ++compared;
    }
  }
  EXPECT_GT(compared, 5000);
}

TEST(BodyDistances, RefuseWhatDoesNotMove) {
  test::Random random(404);
  const SerialChain chain = test::randomChain(random, 3);
  ClearanceConfig config;
  config.capsules = {test::randomCapsule(random, -1), test::randomCapsule(random, -1),
                     test::randomCapsule(random, 1), test::randomCapsule(random, 1)};
  config.walls = {{Vector3::Zero(), Vector3::UnitX()}};
  const auto refuses = [&](std::vector<CapsulePair> pairs, std::vector<WallPair> wall_pairs) {
    config.pairs = std::move(pairs);
    config.wall_pairs = std::move(wall_pairs);
    EXPECT_THROW(BodyDistances(chain, config), std::invalid_argument);
  };
  refuses({{0, 1}}, {});
  refuses({{2, 3}}, {});
  refuses({}, {{0, 0}});
  config.wall_pairs.clear();
  config.capsules.resize(kMaxMovingCapsules + 3, config.capsules.back());
  EXPECT_THROW(BodyDistances(chain, config), std::invalid_argument);
}

TEST(BodyDistances, DoNotDependOnWhichOfTwoIsNamedFirst) {
  test::Random random(405);
  for (int i = 0; i < 200; ++i) {
    const BodiesCase c(random);
    ClearanceConfig swapped = c.config;
    for (CapsulePair& pair : swapped.pairs) std::swap(pair.capsule, pair.other);
    const BodyDistances others(c.chain, swapped);
    for (int index = 0; index < c.distances.size(); ++index)
      ASSERT_EQ(others.distance_m(c.pose, index), c.distances.distance_m(c.pose, index));
  }
}

TEST(BodyDistances, RefuseMoreThanTheyHavePlaceFor) {
  test::Random random(406);
  const SerialChain chain = test::randomChain(random, 3);
  const auto withCapsules = [&](int moving, int fixed) {
    ClearanceConfig config;
    for (int i = 0; i < moving; ++i) config.capsules.push_back(test::randomCapsule(random, 1));
    for (int i = 0; i < fixed; ++i) config.capsules.push_back(test::randomCapsule(random, -1));
    for (int i = 0; i < fixed; ++i) config.pairs.push_back({0, moving + i});
    for (int i = 1; i < moving; ++i) config.pairs.push_back({i, moving});
    return config;
  };
  EXPECT_NO_THROW(BodyDistances(chain, withCapsules(kMaxMovingCapsules, 1)));
  EXPECT_THROW(BodyDistances(chain, withCapsules(kMaxMovingCapsules + 1, 1)),
               std::invalid_argument);
  EXPECT_NO_THROW(BodyDistances(chain, withCapsules(1, kMaxCapsules - 1)));
  EXPECT_THROW(BodyDistances(chain, withCapsules(1, kMaxCapsules)), std::invalid_argument);
}

}  // namespace
}  // namespace tactus
