#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tactus/scene/robot_config.h"
#include "tactus/scene/urdf_loader.h"
#include "tactus/scene/yaml_tree.h"

/// The tactile modules of a robot.yaml, which stand in a list, or as the only one without it.
namespace tactus {

/// The dotted path of a module: "tactile_modules[1]", or "tactile_module".
std::string moduleKey(const YamlNode& root, std::size_t module);

/// A path below a module as this file spells it: either spelling means the first module.
std::string modulePathIn(const YamlNode& root, std::string_view path);

/// Before a path is set: as a whole either spelling takes the place of the other.
void dropOtherSpelling(YamlNode& root, std::string_view path);

/// Checks each module for itself and all together. Throws InputError.
void checkModules(const YamlNode& root, const std::vector<TactileModuleSection>& modules);

std::vector<NamedFrame> moduleLinks(const YamlNode& root,
                                    const std::vector<TactileModuleSection>& modules);

}  // namespace tactus
