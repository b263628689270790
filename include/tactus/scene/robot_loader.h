#pragma once

#include "tactus/scene/config_draft.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/urdf_loader.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// A robot.yaml with its URDF; its other values are in the draft.
struct LoadedRobot {
  YamlNode root;  ///< for the places of values
  UrdfChain chain;
  std::optional<HardwareConfig> hardware;  ///< absent without `can`
};

/// Reads the URDF of a robot.yaml and checks their values against each other. Throws InputError.
LoadedRobot loadRobot(const SourceFile& file, SourceReader& reader, ConfigDraft& draft);

/// One value a moving joint as a vector. Throws InputError if the count is wrong.
JointVector toJointVector(const std::vector<double>& values, const YamlNode& root,
                          const std::string& path, const UrdfChain& chain);

/// Throws InputError unless q is within the position limits.
void checkWithinLimits(const JointVector& q, const YamlNode& root, const std::string& path,
                       const UrdfChain& chain);

}  // namespace tactus
