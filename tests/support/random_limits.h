#pragma once

#include <limits>

#include "support/random_robot.h"

namespace tactus::test {

inline JointLimits randomLimits(Random& random, int count) {
  JointLimits limits = noLimits(count);
  for (int i = 0; i < count; ++i) {
    if (random.chance(0.9)) {
      limits.lower[i] = random.uniform(-3.0, 0.0);
      limits.upper[i] = limits.lower[i] + random.logUniform(1e-3, 6.0);
    }
    if (random.chance(0.9)) limits.max_velocity[i] = random.logUniform(0.01, 10.0);
    if (random.chance(0.9)) limits.max_acceleration[i] = random.logUniform(0.1, 1000.0);
  }
  return limits;
}

/// Anything that fits into a double, numbers a law would command being the most frequent.
inline double hostileNumber(Random& random) {
  switch (random.index(12)) {
    case 0:
      return std::numeric_limits<double>::quiet_NaN();
    case 1:
      return random.sign() * std::numeric_limits<double>::infinity();
    case 2:
      return random.sign() * random.logUniform(1e300, 1.7e308);
    case 3:
      return random.sign() * std::numeric_limits<double>::denorm_min() * random.integer(1, 1000);
    case 4:
      return random.chance(0.5) ? 0.0 : -0.0;
    default:
      return random.sign() * random.logUniform(1e-6, 100.0);
  }
}

}  // namespace tactus::test
