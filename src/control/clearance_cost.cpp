#include "tactus/control/clearance_cost.h"

namespace tactus {

ScaledVector clearanceCost(const ClearanceAvoidance& avoid, const NearBodies& near,
                           const ScaledVector& inv_sqrt_weights) noexcept {
  constexpr double kLever_m = 0.3;  ///< l
  ScaledVector sum = ScaledVector::Zero();
  for (int i = 0; i < near.size; ++i) {
    const NearBody& body = near.body[i];
    const double lacking_m = avoid.distance_m - body.distance_m;
    if (!(lacking_m > 0.0)) continue;
    sum -= (1.0 - body.share) * lacking_m * body.gradient[0];
    if (body.share > 0.0) sum -= body.share * lacking_m * body.gradient[1];
  }
  return avoid.gain_per_s / (kLever_m * kLever_m) * sum.cwiseProduct(inv_sqrt_weights);
}

}  // namespace tactus
