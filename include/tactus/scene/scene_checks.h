#pragma once

#include "tactus/scene/robot_loader.h"
#include "tactus/scene/scene_config.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// Does the simulated module filter a whole number of times a cycle, or once in a whole number of
/// them?
bool fitsModule(double period_s, double filter_rate_hz);

/// Checks the values of a scene against each other and against the robot. Throws InputError.
void checkScene(const YamlNode& root, const SceneConfig& scene, const LoadedRobot& robot,
                const JointVector& q_start);

/// Checks gains against each other, the arm and the period. Throws InputError.
void checkGains(const YamlNode& root, const ControllerConfig& controller, double period_s);

}  // namespace tactus
