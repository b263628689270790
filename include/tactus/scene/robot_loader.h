#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/scene/drive_sheets.h"
#include "tactus/scene/robot_config.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/table_reader.h"
#include "tactus/scene/urdf_bodies.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// A robot.yaml with its URDF.
struct LoadedRobot {
  YamlNode root;  ///< for the places of values
  RobotConfig config;
  UrdfChain chain;
  std::vector<BodyInertia> bodies;         ///< one a joint; none without `dynamics`
  std::optional<HardwareConfig> hardware;  ///< absent without `can`
  std::vector<DriveSheet> sheets;          ///< one for each entry of drives.joints
};

/// Settings of the command line that change the robot have keys that begin like this.
inline constexpr std::string_view kRobotPrefix = "robot.";

/// Settings, and what paths in them are relative to.
struct SceneSettings {
  std::string scene_path;
  const std::vector<Override>& overrides;

  /// The file that `reference` means: relative to the one that names it, on the command line to the
  /// scene. key: as on the command line.
  std::string resolve(const std::string& named_in, std::string_view key,
                      const std::string& reference) const;
};

/// Lays the settings over a robot.yaml, reads it and its URDF and checks their values against each
/// other; adds its numbers to `numbers`. Throws InputError.
LoadedRobot loadRobot(const SourceFile& file, const SceneSettings& settings, SourceReader& reader,
                      NamedNumbers& numbers);

/// One value a moving joint as a vector. Throws InputError if the count is wrong.
JointVector toJointVector(const std::vector<double>& values, const YamlNode& root,
                          const std::string& path, const UrdfChain& chain);

/// Throws InputError unless q is within the position limits.
void checkWithinLimits(const JointVector& q, const YamlNode& root, const std::string& path,
                       const UrdfChain& chain);

}  // namespace tactus
