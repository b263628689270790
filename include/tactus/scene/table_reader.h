#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tactus/scene/robot_config.h"
#include "tactus/scene/scene_config.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// All numbers of a file, defaults included, by dotted path.
using NamedNumbers = std::vector<std::pair<std::string, double>>;

/// Checks a file's tree against its table and returns its values; adds its numbers to `numbers`.
/// Throws InputError at the first value that the table does not allow.
SceneConfig readSceneConfig(const YamlNode& root, NamedNumbers& numbers);
RobotConfig readRobotConfig(const YamlNode& root, NamedNumbers& numbers);

}  // namespace tactus
