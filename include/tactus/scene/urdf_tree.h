#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "tactus/scene/located_error.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// A joint of a URDF; its numbers stay in the XML until a chain needs them.
struct UrdfJoint {
  std::string name;
  std::string type;  ///< as written
  int parent = -1;   ///< link
  int child = -1;    ///< link
  pugi::xml_node node;
};

/// Links and joints of a URDF as a tree with one root. Indices into `links` and `joints`.
struct UrdfTree {
  SourceFile file;
  std::shared_ptr<const std::string> file_name;
  pugi::xml_document document;
  std::string robot_name;
  std::vector<std::string> links;
  std::vector<UrdfJoint> joints;
  std::vector<int> joint_above;  ///< of every link the joint it is the child of; -1 for the root

  SourcePosition position(const pugi::xml_node& node) const;
  int findLink(std::string_view name) const;  ///< -1 if there is none

  /// The joints from the root to a link, root first.
  std::vector<int> pathTo(int link) const;
};

/// Reads and checks the structure: names are unique, every joint connects two known links, every
/// link but one root has exactly one parent, nothing runs in a circle. Throws InputError.
void parseUrdf(const SourceFile& file, UrdfTree& tree);

/// The only child or attribute of a name; empty if there is none. Throws InputError for several.
pugi::xml_node onlyChild(const UrdfTree& tree, const pugi::xml_node& node, const char* name,
                         const std::string& key);
pugi::xml_attribute onlyAttribute(const UrdfTree& tree, const pugi::xml_node& node,
                                  const char* name, const std::string& key);

}  // namespace tactus
