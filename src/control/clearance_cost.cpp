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
  const auto add = [&](double share, const NearBody& body) {
    const double lacking_m = reach_m - body.distance_m;
    if (lacking_m > 0.0) sum -= share * lacking_m * distances.gradient(pose, body);
  };
  for (int i = 0; i < near.size; ++i) {
    if (near.body[i].distance_m >= reach_m) continue;
    const NearStretch stretch = distances.stretch(pose, near.body[i]);
    add(1.0 - stretch.share, near.body[i]);
    if (stretch.share == 0.0) continue;
    for (const NearBody& end : stretch.end) add(0.5 * stretch.share, end);
  }
  return avoid.gain_per_s / (kLever_m * kLever_m) * sum.cwiseProduct(inv_sqrt_weights);
}

}  // namespace tactus
