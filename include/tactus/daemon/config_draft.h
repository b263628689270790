#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// Everything the files of a scene say, each value checked for itself but not yet against the
/// others; becomes a Scene.
struct ConfigDraft {
  // Scene.
  std::string extends;
  std::string robot;  ///< path as written
  double period_s = 0.0;
  double duration_s = 0.0;
  std::vector<double> start;  ///< empty: the robot's home
  std::vector<std::string> components;
  TaskConfig task;
  std::vector<double> weights;  ///< empty: all 1
  std::optional<JointLimitAvoidanceConfig> joint_limit_avoidance;
  std::string variant = "none";
  ForceControlConfig force;
  PlantConfig plant;

  // Robot.
  std::string urdf;  ///< path as written
  std::string tip;
  std::vector<double> home;
  std::vector<double> max_acceleration;  ///< empty: no limit
  std::string module_link;
  TactileModuleConfig module;

  // Both.
  std::vector<std::pair<std::string, double>> numbers;  ///< all of them, by dotted path, as read
};

}  // namespace tactus
