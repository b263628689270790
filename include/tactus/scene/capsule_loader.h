#pragma once

#include <string>
#include <vector>

#include "tactus/scene/robot_loader.h"

namespace tactus {

/// The links that capsules name, and where.
std::vector<NamedFrame> capsuleLinks(const YamlNode& root,
                                     const std::vector<CapsuleSection>& capsules);

struct NamedCapsules {
  std::vector<LinkCapsule> capsules;
  std::vector<std::string> links;  ///< of each
};

/// Of a robot's `collision_capsules`; where it has some and no module is read, the modules' covers
/// are more of them.
NamedCapsules loadCapsules(const LoadedRobot& robot, bool modules_are_read);

}  // namespace tactus
