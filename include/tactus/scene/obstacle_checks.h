#pragma once

#include <vector>

#include "tactus/scene/yaml_tree.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// Checks what several keys of an obstacle say together: one shape, directions with a length, times
/// and foam that rise, and a swing that the run's cycles show. Throws InputError.
void checkObstacles(const YamlNode& root, const std::vector<ObstacleConfig>& obstacles,
                    double period_s);

}  // namespace tactus
