#pragma once

#include <string>

#include "tactus/scene/robot_loader.h"
#include "tactus/scene/scene_config.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// A scene, and where to say what is wrong with it.
struct CheckedScene {
  const YamlNode& root;
  const SceneConfig& scene;
  const LoadedRobot& robot;
  const JointVector& q_start;

  /// Throws InputError with the place of this key.
  [[noreturn]] void fail(const std::string& path, const std::string& problem,
                         const std::string& expectation) const;
};

/// Checks the task's components and its motion against each other and the arm. Throws InputError.
void checkTask(const CheckedScene& checked);

}  // namespace tactus
