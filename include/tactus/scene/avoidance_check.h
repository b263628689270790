#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// Throws InputError if clearance.avoid drives two bodies apart faster than a cycle can follow, so
/// that the null space overshoots: with the longest levers that a pair has where the arm was
/// looked at, its start and kDrawnConfigurations. Pairs that are avoided together add up.
void checkAvoidance(const YamlNode& root, const ControllerConfig& controller, double period_s);

}  // namespace tactus
