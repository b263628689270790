#pragma once

#include <string>

#include "tactus/scene/scene.h"

namespace tactus {

/// What a tactile module can show at most, N: more ends in a fault.
struct SensorRange {
  double force_N;
  bool is_of_channels;  ///< the first of them is at its end before max_force_N

  /// "the sensor's max_force_N is 100"
  std::string text() const;
};

SensorRange sensorRange(const Scene& scene, int module);

}  // namespace tactus
