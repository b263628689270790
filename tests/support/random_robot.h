#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "support/random.h"
#include "tactus/control/controller_config.h"

namespace tactus::test {

inline Vector3 randomAxis(Random& random) {
  if (random.chance(0.5)) return random.unitVector();
  return random.sign() * Vector3::Unit(random.index(3));
}

inline std::vector<Joint> randomJoints(Random& random, int count) {
  std::vector<Joint> joints(count);
  for (Joint& joint : joints) {
    joint.type = random.chance(0.3) ? JointType::kPrismatic : JointType::kRevolute;
    joint.axis = randomAxis(random);
    joint.X_ParentJoint.p_AB = random.vector<Vector3>(3, -0.4, 0.4);
    if (random.chance(0.5)) joint.X_ParentJoint.R_AB = random.rotation();
  }
  return joints;
}

inline AttachedFrame randomFrame(Random& random, int joint) {
  return {joint, {random.rotation(), random.vector<Vector3>(3, -0.3, 0.3)}};
}

inline SerialChain randomChain(Random& random, int count) {
  return SerialChain(randomJoints(random, count), randomFrame(random, count - 1));
}

/// Condition number up to 1e4.
inline JointVector randomWeights(Random& random, int count) {
  JointVector weights(count);
  for (double& weight : weights) weight = random.logUniform(1e-2, 1e2);
  return weights;
}

inline JointLimits noLimits(int count) {
  const JointVector infinite = JointVector::Constant(count, kNoLimit);
  return {-infinite, infinite, infinite, infinite};
}

/// `size` different components in random order.
inline std::array<int, kMaxTaskSize> randomComponents(Random& random) {
  std::array<int, kMaxTaskSize> components{0, 1, 2, 3, 4, 5};
  for (int i = kMaxTaskSize - 1; i > 0; --i)
    std::swap(components[i], components[random.index(i + 1)]);
  return components;
}

/// A robot at a random pose that holds its tool, with a module on a random link. Nothing limits it.
inline ControllerConfig randomController(Random& random, int count, int task_size) {
  ControllerConfig config{.chain = randomChain(random, count)};
  config.q_start = random.vector(count, -2.0, 2.0);
  config.limits = noLimits(count);
  config.task.components = randomComponents(random);
  config.task.size = task_size;
  config.weights = JointVector::Ones(count);
  config.tactile_modules.emplace_back();
  config.tactile_modules.front().link = randomFrame(random, random.integer(1, count - 1));
  config.tactile_modules.front().length_m = 0.4;
  return config;
}

}  // namespace tactus::test
