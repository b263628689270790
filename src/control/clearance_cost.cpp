#include "tactus/control/clearance_cost.h"

#include <algorithm>

namespace tactus {

ScaledVector clearanceCost(const ClearanceAvoidance& avoid, const BodyDistances& distances,
                           const ChainPose& pose, const NearBodies& near,
                           const ScaledVector& inv_sqrt_weights) noexcept {
  constexpr double kLever_m = 0.3;  ///< l
  // Of bodies that there is no room for nothing may be missed once they come or go.
  const double reach_m = std::min(avoid.distance_m, near.beyond_m);
  ScaledVector sum = ScaledVector::Zero();
  for (int i = 0; i < near.size; ++i) {
    const double lacking_m = reach_m - near.body[i].distance_m;
    if (lacking_m > 0.0) sum -= lacking_m * distances.gradient(pose, near.body[i]);
  }
  return avoid.gain_per_s / (kLever_m * kLever_m) * sum.cwiseProduct(inv_sqrt_weights);
}

}  // namespace tactus
