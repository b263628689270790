#include "tactus/scene/drawn_configurations.h"

#include <cmath>
#include <numbers>

namespace tactus {

JointVector drawnConfiguration(const SerialChain& chain, const JointLimits& limits, int number) {
  constexpr int kPrimes[kMaxJoints] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53};
  JointVector q(chain.size());
  for (int i = 0; i < q.size(); ++i) {
    double share = 0.0;
    double digit = 1.0;
    for (int rest = number; rest > 0; rest /= kPrimes[i]) {
      digit /= kPrimes[i];
      share += digit * (rest % kPrimes[i]);
    }
    const double endless = chain.type(i) == JointType::kPrismatic ? 1.0 : std::numbers::pi;
    const double lower = limits.lower[i], upper = limits.upper[i];
    const bool is_limited = std::isfinite(lower) && std::isfinite(upper);
    q[i] = is_limited ? lower + share * (upper - lower) : (2.0 * share - 1.0) * endless;
  }
  return q;
}

}  // namespace tactus
