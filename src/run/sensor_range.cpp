#include "tactus/run/sensor_range.h"

#include <fmt/format.h>

#include "tactus/analysis/channel_range.h"

namespace tactus {

std::string SensorRange::text() const {
  if (is_of_channels)
    return fmt::format("a channel of the sensor is at its end at {:.3g} N", force_N);
  return fmt::format("the sensor's max_force_N is {:g}", force_N);
}

SensorRange sensorRange(const Scene& scene, int module) {
  const TactileModuleConfig& read = scene.controller.tactile_modules[module];
  const double rail_N = railForce_N(scene.plant.modules[module].channels, read.length_m);
  if (rail_N < read.max_force_N) return {rail_N, true};
  return {read.max_force_N, false};
}

}  // namespace tactus
