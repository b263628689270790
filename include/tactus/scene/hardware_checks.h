#pragma once

#include <optional>
#include <vector>

#include "tactus/canopen/hardware_config.h"
#include "tactus/plant/trouble.h"
#include "tactus/scene/robot_loader.h"
#include "tactus/scene/scene_config.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// Checks the hardware that a scene needs of a robot with a can section against the scene's cycle,
/// and the cycle against what drives can be told, and their data sheets against both. `scene` is
/// the root of its file. Throws InputError.
void checkHardware(const YamlNode& scene, const LoadedRobot& robot, double period_s,
                   const HardwareConfig& hardware);

/// The scene's troubles, checked against the hardware that they happen to. `root` is the scene's.
/// Throws InputError.
std::vector<Trouble> loadTroubles(const YamlNode& root, const std::vector<TroubleSection>& troubles,
                                  const std::optional<HardwareConfig>& hardware);

}  // namespace tactus
