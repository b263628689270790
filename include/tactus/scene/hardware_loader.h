#pragma once

#include <optional>

#include "tactus/canopen/hardware_config.h"
#include "tactus/scene/drive_sheets.h"
#include "tactus/scene/robot_config.h"
#include "tactus/scene/urdf_loader.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// Buses, drives, module and lines of a robot.yaml that has been read, checked against each other
/// and against the URDF; nothing without a `can` section. sheets: one for each entry of
/// drives.joints. Throws InputError.
std::optional<HardwareConfig> loadHardware(const YamlNode& root, const RobotConfig& config,
                                           const UrdfChain& chain,
                                           const std::vector<DriveSheet>& sheets);

/// The same without tactile modules, and without buses that nothing else is on.
HardwareConfig withoutTactileModules(const HardwareConfig& hardware);

}  // namespace tactus
