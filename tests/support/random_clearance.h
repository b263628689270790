#pragma once

#include <algorithm>

#include "support/random_robot.h"
#include "tactus/control/nearest_body.h"

/// What a random arm must keep clear of: itself, walls, balls and bars around it.
namespace tactus::test {

inline LinkCapsule randomCapsule(Random& random, int joint) {
  LinkCapsule capsule{randomFrame(random, joint), random.vector<Vector3>(3, -0.2, 0.2), {}, 0.0};
  capsule.p_LinkTo = random.chance(0.1)
                         ? capsule.p_LinkFrom
                         : Vector3(capsule.p_LinkFrom + random.vector<Vector3>(3, -0.4, 0.4));
  capsule.radius_m = random.logUniform(0.005, 0.1);
  return capsule;
}

/// Of one or two capsules a link, and bodies around them.
inline ClearanceConfig randomBodies(Random& random, int joints) {
  ClearanceConfig config;
  for (int joint = 0; joint < joints; ++joint)
    for (int i = random.integer(1, 2); i > 0; --i)
      config.capsules.push_back(randomCapsule(random, joint));
  for (int i = random.index(5); i > 0; --i) {
    LinkCapsule body = randomCapsule(random, -1);
    body.link.X_JointFrame.p_AB *= 5.0;
    config.capsules.push_back(body);
  }
  for (int i = random.index(4); i > 0; --i)
    config.walls.push_back({random.vector<Vector3>(3, -1.5, 1.5), random.unitVector()});
  const int capsules = static_cast<int>(config.capsules.size());
  for (int a = 0; a < capsules; ++a) {
    const int joint = config.capsules[a].link.joint;
    if (joint < 0) continue;
    for (int b = 0; b < capsules; ++b)
      if (config.capsules[b].link.joint < joint - (random.chance(0.2) ? 0 : 1))
        config.pairs.push_back({a, b});
    for (int wall = 0; wall < static_cast<int>(config.walls.size()); ++wall)
      config.wall_pairs.push_back({a, wall});
  }
  config.safe_distance_m = random.chance(0.2) ? 0.0 : random.logUniform(1e-3, 0.05);
  config.influence_distance_m = config.safe_distance_m + random.logUniform(0.01, 0.3);
  if (random.chance(0.3))
    config.avoid = {config.safe_distance_m + random.logUniform(0.01, 0.3),
                    random.logUniform(0.1, 10.0)};
  return config;
}

/// Only what is clear at q.
inline void leaveOutTouching(const SerialChain& chain, const JointVector& q,
                             ClearanceConfig& config) {
  ChainPose pose;
  chain.computePose(q, pose);
  const BodyDistances distances(chain, config);
  const int pairs = static_cast<int>(config.pairs.size());
  const auto isTouching = [&](int index) {
    return distances.distance_m(pose, index) < config.safe_distance_m + 1e-6;
  };
  ClearanceConfig clear = config;
  clear.pairs.clear();
  clear.wall_pairs.clear();
  for (int i = 0; i < distances.size(); ++i) {
    if (isTouching(i)) continue;
    if (i < pairs) clear.pairs.push_back(config.pairs[i]);
    if (i >= pairs) clear.wall_pairs.push_back(config.wall_pairs[i - pairs]);
  }
  config = clear;
}

}  // namespace tactus::test
