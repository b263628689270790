#include "tactus/scene/urdf_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

namespace tactus {
namespace {

/// A log holds names in messages of 64 KiB; file systems stop at 255 bytes as well.
constexpr std::size_t kMaxNameBytes = 255;

using LinkIndex = std::unordered_map<std::string, int>;

void checkLength(const UrdfTree& tree, const pugi::xml_node& node, const std::string& key,
                 std::string_view name) {
  if (name.size() <= kMaxNameBytes) return;
  failAt(tree.position(node), key, fmt::format("{} bytes long", name.size()),
         fmt::format("expected at most {}", kMaxNameBytes));
}

std::string requiredAttribute(const UrdfTree& tree, const pugi::xml_node& node, const char* name,
                              const std::string& key) {
  const pugi::xml_attribute attribute = onlyAttribute(tree, node, name, key);
  if (!*attribute.value()) {
    failAt(tree.position(node), key + "." + name, "is missing",
           fmt::format("expected an attribute {} with text", name));
  }
  checkLength(tree, node, key + "." + name, attribute.value());
  return attribute.value();
}

void parseDocument(UrdfTree& tree) {
  const pugi::xml_parse_result result = tree.document.load_buffer(
      tree.file.text.data(), tree.file.text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    failAt(positionAt(tree.file_name, tree.file.text, static_cast<std::size_t>(result.offset)), "-",
           result.description(), "expected well-formed XML");
  }
  const pugi::xml_node robot = tree.document.document_element();
  if (std::string_view(robot.name()) != "robot") {
    failAt(tree.position(robot), "-", "the document element is " + inQuotes(robot.name()),
           "expected <robot>");
  }
  for (pugi::xml_node next = robot.next_sibling(); next; next = next.next_sibling()) {
    if (next.type() == pugi::node_element)  // pugixml takes it
      failAt(tree.position(next), "-", inQuotes(next.name()) + " after the end of <robot>",
             "expected one document element");
  }
  tree.robot_name = robot.attribute("name").value();
  checkLength(tree, robot, "robot.name", tree.robot_name);
}

LinkIndex readLinks(UrdfTree& tree) {
  LinkIndex index;
  for (const pugi::xml_node& node : tree.document.document_element().children("link")) {
    const std::string name = requiredAttribute(tree, node, "name", "link");
    if (!index.emplace(name, static_cast<int>(tree.links.size())).second) {
      failAt(tree.position(node), "link." + name, "a second link of this name",
             "expected unique names");
    }
    tree.links.push_back(name);
  }
  return index;
}

int readLinkOf(const UrdfTree& tree, const pugi::xml_node& joint, const char* element,
               const std::string& key, const LinkIndex& index) {
  const pugi::xml_node node = onlyChild(tree, joint, element, key);
  if (!node) {
    failAt(tree.position(joint), key + "." + element, "is missing",
           fmt::format("expected an element <{} link=\"...\">", element));
  }
  const std::string name = requiredAttribute(tree, node, "link", key + "." + element);
  const auto found = index.find(name);
  if (found == index.end()) {
    failAt(tree.position(node), key + "." + element, inQuotes(name) + " is no link",
           "expected the name of a <link>");
  }
  return found->second;
}

void readJoints(UrdfTree& tree, const LinkIndex& index) {
  std::unordered_map<std::string, int> names;
  tree.joint_above.assign(tree.links.size(), -1);
  for (const pugi::xml_node& node : tree.document.document_element().children("joint")) {
    UrdfJoint joint;
    joint.node = node;
    joint.name = requiredAttribute(tree, node, "name", "joint");
    const std::string key = "joint." + joint.name;
    if (!names.emplace(joint.name, 0).second) {
      failAt(tree.position(node), key, "a second joint of this name", "expected unique names");
    }
    joint.type = requiredAttribute(tree, node, "type", key);
    joint.parent = readLinkOf(tree, node, "parent", key, index);
    joint.child = readLinkOf(tree, node, "child", key, index);
    int& above = tree.joint_above[joint.child];
    if (above >= 0) {
      failAt(tree.position(node), key + ".child",
             fmt::format("{} is already the child of joint {}", inQuotes(tree.links[joint.child]),
                         inQuotes(tree.joints[above].name)),
             "expected one parent a link");
    }
    above = static_cast<int>(tree.joints.size());
    tree.joints.push_back(std::move(joint));
  }
}

void checkOneRoot(const UrdfTree& tree) {
  const SourcePosition at = tree.position(tree.document.document_element());
  const auto root = std::ranges::find(tree.joint_above, -1);
  if (tree.links.empty()) failAt(at, "robot", "has no link", "expected links and joints");
  if (root == tree.joint_above.end()) {
    failAt(at, "robot", "every link has a parent: the joints run in a circle",
           "expected one root link");
  }
  const auto second = std::find(root + 1, tree.joint_above.end(), -1);
  if (second == tree.joint_above.end()) return;
  const auto name = [&](auto link) {
    return inQuotes(tree.links[link - tree.joint_above.begin()]);
  };
  failAt(at, "robot", fmt::format("links {} and {} both have no parent", name(root), name(second)),
         "expected one root link");
}

/// With one root and one parent a link, what does not hang on the root runs in a circle.
void checkNoCircle(const UrdfTree& tree) {
  std::vector<std::vector<int>> joints_below(tree.links.size());
  for (std::size_t j = 0; j < tree.joints.size(); ++j) {
    joints_below[tree.joints[j].parent].push_back(static_cast<int>(j));
  }
  std::vector<bool> reached(tree.links.size(), false);
  std::vector<int> open = {
      static_cast<int>(std::ranges::find(tree.joint_above, -1) - tree.joint_above.begin())};
  while (!open.empty()) {
    const int link = open.back();
    open.pop_back();
    reached[link] = true;
    for (const int j : joints_below[link]) open.push_back(tree.joints[j].child);
  }
  for (std::size_t link = 0; link < reached.size(); ++link) {
    if (reached[link]) continue;
    const UrdfJoint& joint = tree.joints[tree.joint_above[link]];
    failAt(tree.position(joint.node), "joint." + joint.name, "hangs on a circle of joints",
           "expected every link to hang on the root");
  }
}

}  // namespace

SourcePosition UrdfTree::position(const pugi::xml_node& node) const {
  // The parser points behind the opening bracket.
  const std::ptrdiff_t offset = std::max<std::ptrdiff_t>(node.offset_debug() - 1, 0);
  return positionAt(file_name, file.text, static_cast<std::size_t>(offset));
}

int UrdfTree::findLink(std::string_view name) const {
  const auto found = std::ranges::find(links, name);
  return found == links.end() ? -1 : static_cast<int>(found - links.begin());
}

std::vector<int> UrdfTree::pathTo(int link) const {
  std::vector<int> path;
  for (int j = joint_above[link]; j >= 0; j = joint_above[joints[j].parent]) path.push_back(j);
  std::ranges::reverse(path);
  return path;
}

void parseUrdf(const SourceFile& file, UrdfTree& tree) {
  tree.file = file;
  tree.file_name = std::make_shared<std::string>(file.path);
  parseDocument(tree);
  readJoints(tree, readLinks(tree));
  checkOneRoot(tree);
  checkNoCircle(tree);
}

pugi::xml_node onlyChild(const UrdfTree& tree, const pugi::xml_node& node, const char* name,
                         const std::string& key) {
  const pugi::xml_node first = node.child(name);
  if (const pugi::xml_node second = first.next_sibling(name)) {
    failAt(tree.position(second), key + "." + name, "given twice", "expected once");
  }
  return first;
}

pugi::xml_attribute onlyAttribute(const UrdfTree& tree, const pugi::xml_node& node,
                                  const char* name, const std::string& key) {
  const pugi::xml_attribute first = node.attribute(name);
  for (pugi::xml_attribute other = first.next_attribute(); other; other = other.next_attribute()) {
    if (std::string_view(other.name()) == name) {
      failAt(tree.position(node), key + "." + name, "given twice", "expected once");
    }
  }
  return first;
}

}  // namespace tactus
