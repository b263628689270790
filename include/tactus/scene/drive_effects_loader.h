#pragma once

#include "tactus/scene/robot_loader.h"
#include "tactus/scene/scene_config.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// What `simulation.drives` says, put into `plant`, whose dynamics are those of `simulation.arm`.
/// Throws InputError where the arm cannot have it.
void loadDriveEffects(const YamlNode& scene, const SimulationSection& simulation,
                      const LoadedRobot& robot, double period_s, PlantConfig& plant);

}  // namespace tactus
