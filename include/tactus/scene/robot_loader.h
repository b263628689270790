#pragma once

#include "tactus/scene/robot_config.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/table_reader.h"
#include "tactus/scene/urdf_loader.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// A robot.yaml with its URDF.
struct LoadedRobot {
  YamlNode root;  ///< for the places of values
  RobotConfig config;
  UrdfChain chain;
  std::optional<HardwareConfig> hardware;  ///< absent without `can`
};

/// Reads a robot.yaml and its URDF and checks their values against each other; adds its numbers to
/// `numbers`. Throws InputError.
LoadedRobot loadRobot(const SourceFile& file, SourceReader& reader, NamedNumbers& numbers);

/// One value a moving joint as a vector. Throws InputError if the count is wrong.
JointVector toJointVector(const std::vector<double>& values, const YamlNode& root,
                          const std::string& path, const UrdfChain& chain);

/// Throws InputError unless q is within the position limits.
void checkWithinLimits(const JointVector& q, const YamlNode& root, const std::string& path,
                       const UrdfChain& chain);

}  // namespace tactus
