#pragma once

#include <optional>
#include <string>

#include "tactus/scene/robot_loader.h"
#include "tactus/scene/scene.h"
#include "tactus/scene/scene_config.h"

namespace tactus {

struct NamedClearance {
  ClearanceConfig config;
  ClearanceNames names;
};

/// What the scene's `clearance` keeps the robot's collision_capsules and covers clear of; absent
/// without that section. Left out are pairs of one link and of neighbours, and what joints do not
/// change: links that always touch each other, bodies that do not get nearer. Throws InputError,
/// also where the start is not clear.
std::optional<NamedClearance> loadClearance(const YamlNode& root, const SceneConfig& scene,
                                            const LoadedRobot& robot, const JointVector& q_start);

/// Both of a pair or wall pair of BodyDistances, by their names.
std::string namesOfPair(const ClearanceConfig& config, const ClearanceNames& names, int index);

}  // namespace tactus
