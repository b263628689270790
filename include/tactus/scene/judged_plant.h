#pragma once

#include <string>

#include "tactus/scene/scene.h"

namespace tactus {

/// What tactusd runs on is the robot of robot.yaml: a scene that simulates quicker drives or
/// filters says nothing of it, slower ones count.
PlantConfig judgedPlant(const Scene& scene);

/// A warning of what the simulation has and the loops have not; empty: nothing.
std::string leftOut(const PlantConfig& plant);

}  // namespace tactus
