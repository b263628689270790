#include "tactus/scene/urdf_completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tactus/scene/urdf_node.h"
#include "tactus/scene/urdf_tree.h"

namespace tactus {
namespace {

bool isMoving(const UrdfJoint& joint) { return joint.type != "fixed"; }

/// Refuses what is there and no number with its place: a copy with another value would hide it.
void refuseNoLimits(const UrdfNode& joint, const std::string& type) {
  if (type != "continuous")
    for (const char* name : {"lower", "upper"}) joint.number("limit", name, kMaxUrdfLimit, 0.0);
  joint.number("limit", "velocity", kMaxUrdfLimit, 0.0);
}

/// Absent, or a zero.
bool isUnsaid(const pugi::xml_attribute& attribute) { return attribute.as_double() == 0.0; }

void setNumber(pugi::xml_node limit, const char* name, double value) {
  pugi::xml_attribute attribute = limit.attribute(name);
  if (!attribute) attribute = limit.append_attribute(name);
  attribute.set_value(fmt::format("{:g}", value).c_str());
}

/// One that is there holds as it is written, unless both are zero. Names what was set.
void completePositions(pugi::xml_node limit, double reach, std::vector<std::string>& set) {
  const pugi::xml_attribute lower = limit.attribute("lower"), upper = limit.attribute("upper");
  const bool are_both_zero = lower && upper && isUnsaid(lower) && isUnsaid(upper);
  const bool has_lower = lower && !are_both_zero, has_upper = upper && !are_both_zero;
  const double from = has_lower ? lower.as_double() : std::min(-reach, upper.as_double() - reach);
  if (!has_lower) {
    setNumber(limit, "lower", from);
    set.emplace_back("lower");
  }
  if (!has_upper) {
    setNumber(limit, "upper", std::max(reach, from + reach));
    set.emplace_back("upper");
  }
}

/// What was set; empty: nothing.
std::string completeJoint(pugi::xml_node joint, const std::string& type) {
  const bool is_prismatic = type == "prismatic";
  pugi::xml_node limit = joint.child("limit");
  if (!limit) limit = joint.append_child("limit");
  std::vector<std::string> set;
  if (type != "continuous") completePositions(limit, is_prismatic ? 0.25 : 2.5, set);
  if (isUnsaid(limit.attribute("velocity"))) {
    setNumber(limit, "velocity", is_prismatic ? 0.1 : 0.5);
    set.emplace_back("velocity");
  }
  if (set.empty()) return "";
  const std::string what = fmt::format("{}", fmt::join(set, ", "));
  joint.insert_child_before(pugi::node_comment, limit)
      .set_value((" ASSUMED by tactus init: " + what + " ").c_str());
  return what;
}

pugi::xml_node jointNamed(pugi::xml_document& document, const std::string& name) {
  return document.document_element().find_child([&](const pugi::xml_node& node) {
    return std::string_view(node.name()) == "joint" && node.attribute("name").value() == name;
  });
}

}  // namespace

std::vector<ArmEnd> armEnds(const SourceFile& urdf) {
  UrdfTree tree;
  parseUrdf(urdf, tree);
  std::vector<bool> carries(tree.links.size(), false);
  for (const UrdfJoint& joint : tree.joints) carries[joint.parent] = true;
  std::vector<ArmEnd> ends;
  for (std::size_t link = 0; link < tree.links.size(); ++link) {
    if (carries[link]) continue;
    const std::vector<int> path = tree.pathTo(static_cast<int>(link));
    const auto moving =
        std::ranges::count_if(path, [&](int joint) { return isMoving(tree.joints[joint]); });
    ends.push_back({tree.links[link], static_cast<int>(moving)});
  }
  std::ranges::stable_sort(ends, std::greater<>{}, &ArmEnd::moving_joints);
  return ends;
}

CompletedUrdf completeLimits(const SourceFile& urdf, const std::string& tip) {
  UrdfTree tree;
  parseUrdf(urdf, tree);
  const int link = tree.findLink(tip);
  CompletedUrdf completed;
  if (link < 0) return completed;
  pugi::xml_document document;
  document.load_buffer(urdf.text.data(), urdf.text.size(),
                       pugi::parse_full & ~pugi::parse_ws_pcdata, pugi::encoding_utf8);
  for (const int index : tree.pathTo(link)) {
    const UrdfJoint& joint = tree.joints[index];
    const bool is_known =
        joint.type == "prismatic" || joint.type == "revolute" || joint.type == "continuous";
    if (!is_known) continue;
    refuseNoLimits({tree, joint.node, "joint." + joint.name}, joint.type);
    const std::string what = completeJoint(jointNamed(document, joint.name), joint.type);
    if (!what.empty()) completed.assumed.push_back({joint.name, what});
  }
  if (completed.assumed.empty()) return completed;
  std::ostringstream text;
  document.save(text, "  ", pugi::format_default, pugi::encoding_utf8);
  completed.text = text.str();
  return completed;
}

}  // namespace tactus
