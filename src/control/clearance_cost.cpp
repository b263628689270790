#include "tactus/control/clearance_cost.h"

#include <algorithm>

namespace tactus {

ScaledVector clearanceCost(const ClearanceAvoidance& avoid, const BodyDistances& distances,
                           const ChainPose& pose, const NearBodies& near,
                           const ScaledVector& inv_sqrt_weights) noexcept {
  // Of bodies that there is no room for nothing may be missed once they come or go.
  const double reach_m = std::min(avoid.distance_m, near.beyond_m);
  ScaledVector sum = ScaledVector::Zero();
  forEachThatCosts(distances, pose, near, reach_m, [&](double share, const NearBody& body) {
    sum -= share * (reach_m - body.distance_m) * distances.gradient(pose, body);
  });
  return avoid.gain_per_s / (kClearanceLever_m * kClearanceLever_m) *
         sum.cwiseProduct(inv_sqrt_weights);
}

}  // namespace tactus
