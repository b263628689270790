#include "tactus/scene/judged_plant.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace tactus {

PlantConfig judgedPlant(const Scene& scene) {
  PlantConfig plant = scene.plant;
  if (!scene.hardware) return plant;
  plant.drive_lag_s = std::max(plant.drive_lag_s, scene.controller.drive_lag_s);
  const std::size_t modules =
      std::min(plant.modules.size(), scene.controller.tactile_modules.size());
  for (std::size_t i = 0; i < modules; ++i) {
    double& cutoff_hz = plant.modules[i].filter_cutoff_hz;
    cutoff_hz = std::min(cutoff_hz, scene.controller.tactile_modules[i].filter_cutoff_hz);
  }
  return plant;
}

std::string leftOut(const PlantConfig& plant) {
  std::vector<std::string> keys;
  if (plant.drives.loop) keys.emplace_back("drives.bandwidth_hz");
  if (plant.drives.dead_time_s > 0.0) keys.emplace_back("drives.dead_time_s");
  if (plant.drives.max_acceleration.size() > 0) keys.emplace_back("drives.max_acceleration");
  const auto nameIfAny = [&](const char* key, auto isImperfect) {
    if (std::ranges::any_of(plant.modules, isImperfect)) keys.emplace_back(key);
  };
  using Module = SimulatedModuleConfig;
  nameIfAny("tactile_module.channel_gains", [](const Module& module) {
    return std::ranges::any_of(module.channel_gains, [](double gain) { return gain != 1.0; });
  });
  nameIfAny("tactile_module.direction_error_rad",
            [](const Module& module) { return module.direction_error_rad != 0.0; });
  nameIfAny("tactile_module.jitter_s", [](const Module& module) { return module.jitter_s > 0.0; });
  nameIfAny("tactile_module.lost_share",
            [](const Module& module) { return module.lost_share > 0.0; });
  if (keys.empty()) return "";
  return fmt::format("the margins do not know simulation.{}: its contacts may be less stable",
                     fmt::join(keys, ", "));
}

}  // namespace tactus
