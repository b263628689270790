#pragma once

#include <optional>

#include "tactus/daemon/config_draft.h"
#include "tactus/daemon/urdf_loader.h"
#include "tactus/daemon/yaml_tree.h"
#include "tactus/io/hardware_config.h"

namespace tactus {

/// Buses, drives, module and lines of a robot.yaml that has been read, checked against each other
/// and against the URDF; nothing without a `can` section. Throws InputError.
std::optional<HardwareConfig> loadHardware(const YamlNode& root, const ConfigDraft& draft,
                                           const UrdfChain& chain);

/// The same without the tactile module, and without buses that nothing else is on.
HardwareConfig withoutTactileModule(const HardwareConfig& hardware);

}  // namespace tactus
