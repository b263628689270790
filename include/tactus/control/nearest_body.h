#pragma once

#include "tactus/control/body_distances.h"

namespace tactus {

/// Of all pairs and wall pairs, for reports.
struct NearestBody {
  int index = -1;  ///< of BodyDistances; -1: there are none
  double distance_m = kNoLimit;
};

inline NearestBody nearestBody(const BodyDistances& distances, const ChainPose& pose) noexcept {
  NearestBody nearest;
  for (int i = 0; i < distances.size(); ++i) {
    const double distance_m = distances.distance_m(pose, i);
    if (distance_m < nearest.distance_m) nearest = {i, distance_m};
  }
  return nearest;
}

}  // namespace tactus
