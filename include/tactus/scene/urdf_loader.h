#pragma once

#include <string>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/scene/urdf_tree.h"

namespace tactus {

/// A frame by its URDF name, and where the name was given.
struct NamedFrame {
  std::string link;
  std::string key;
  SourcePosition at;
};

/// A link of the chain, as an index into UrdfTree::links, and where it is by its last moving joint.
struct PlacedLink {
  int link;
  AttachedFrame frame;
};

/// What a controller needs of a URDF: the moving joints from the root to the tip, fixed joints
/// merged, everything beside them ignored.
struct UrdfChain {
  std::string robot_name;
  std::vector<std::string> joint_names;
  std::vector<Joint> joints;
  AttachedFrame tip;
  std::vector<AttachedFrame> module_links, capsule_links;
  std::vector<PlacedLink> links;  ///< from the root to the tip
  JointVector max_effort;         ///< N or Nm; infinite where it is absent or 0
  JointLimits limits;             ///< accelerations unlimited; positions of continuous joints too
};

/// Throws InputError. `module_links` are links of the chain or fixed to it, moved by at least one
/// joint; `capsule_links` may be fixed to the base, too.
UrdfChain loadUrdfChain(const SourceFile& file, const NamedFrame& tip,
                        const std::vector<NamedFrame>& module_links,
                        const std::vector<NamedFrame>& capsule_links = {});

}  // namespace tactus
