#include "tactus/scene/urdf_loader.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactus/scene/urdf_node.h"

namespace tactus {
namespace {

constexpr double kMaxAxis = 1e3;
constexpr double kMaxEffort = 1e9;

/// One joint of the chain while it is read.
struct JointReader : UrdfNode {
  JointReader(const UrdfTree& of, const UrdfJoint& read)
      : UrdfNode{of, read.node, "joint." + read.name}, joint(read) {}

  const UrdfJoint& joint;
};

Vector3 readAxis(const JointReader& reader) {
  const Vector3 axis = reader.vector("axis", "xyz", kMaxAxis, Vector3::UnitX());
  constexpr double kMinLength = 1e-6;
  if (axis.norm() < kMinLength) {
    reader.fail(reader.child("axis"), "axis.xyz", "the axis has no length",
                "a vector other than zero");
  }
  return axis.normalized();
}

struct MovingJoint {
  Joint joint;
  double lower = -kNoLimit, upper = kNoLimit, max_velocity = kNoLimit, max_effort = kNoLimit;
};

MovingJoint readMovingJoint(const JointReader& reader) {
  const std::string& type = reader.joint.type;
  MovingJoint result;
  result.joint.type = type == "prismatic" ? JointType::kPrismatic : JointType::kRevolute;
  result.joint.axis = readAxis(reader);
  if (type != "continuous") {
    result.lower = reader.number("limit", "lower", kMaxUrdfLimit, kRequired);
    result.upper = reader.number("limit", "upper", kMaxUrdfLimit, kRequired);
    if (result.lower >= result.upper) {
      reader.fail(reader.child("limit"), "limit",
                  fmt::format("lower {} is not below upper {}", result.lower, result.upper),
                  "lower < upper");
    }
  }
  result.max_velocity = reader.number("limit", "velocity", kMaxUrdfLimit, kRequired);
  if (result.max_velocity <= 0.0) {
    reader.fail(reader.child("limit"), "limit.velocity", "is not positive",
                "a number > 0 in m/s or rad/s");
  }
  const double effort = reader.number("limit", "effort", kMaxEffort, 0.0);
  if (effort > 0.0) result.max_effort = effort;  // 0 is what exporters write for none
  return result;
}

void checkType(const JointReader& reader) {
  const std::string& type = reader.joint.type;
  if (type != "fixed" && type != "prismatic" && type != "revolute" && type != "continuous") {
    reader.fail(reader.joint.node, "type", inQuotes(type) + " on the way to the tip",
                "prismatic, revolute, continuous or fixed");
  }
  if (const pugi::xml_node mimic = reader.child("mimic")) {
    reader.fail(mimic, "mimic", "the joint follows another one", "joints that move on their own");
  }
}

int requireLink(const UrdfTree& tree, const NamedFrame& frame) {
  const int link = tree.findLink(frame.link);
  if (link < 0) {
    const std::string nearest = nearestWord(frame.link, tree.links);
    failAt(frame.at, frame.key, inQuotes(frame.link) + " is no link of " + tree.file.path,
           nearest.empty() ? "expected the name of a link"
                           : fmt::format("expected perhaps {}", inQuotes(nearest)));
  }
  return link;
}

/// The frame of a link that hangs on the chain by fixed joints only.
AttachedFrame frameBesideChain(const UrdfTree& tree, const std::vector<PlacedLink>& placed,
                               const NamedFrame& named) {
  int link = requireLink(tree, named);
  Pose X_LinkFrame;
  while (true) {
    const auto on_chain = std::ranges::find(placed, link, &PlacedLink::link);
    if (on_chain != placed.end()) {
      const AttachedFrame& frame = on_chain->frame;
      return {frame.joint, frame.X_JointFrame * X_LinkFrame};
    }
    // The root is on the chain, so every other link has a joint above.
    const JointReader reader{tree, tree.joints[tree.joint_above[link]]};
    if (reader.joint.type != "fixed") {
      failAt(named.at, named.key,
             fmt::format("{} moves with joint {}, which is not on the way to the tip",
                         inQuotes(named.link), inQuotes(reader.joint.name)),
             "expected a link on the way to the tip or fixed to one");
    }
    X_LinkFrame = reader.origin() * X_LinkFrame;
    link = reader.joint.parent;
  }
}

void setLimits(const std::vector<MovingJoint>& moving, JointLimits& limits) {
  const auto n = static_cast<Eigen::Index>(moving.size());
  limits.lower.resize(n);
  limits.upper.resize(n);
  limits.max_velocity.resize(n);
  limits.max_acceleration.setConstant(n, kNoLimit);
  for (Eigen::Index i = 0; i < n; ++i) {
    limits.lower[i] = moving[i].lower;
    limits.upper[i] = moving[i].upper;
    limits.max_velocity[i] = moving[i].max_velocity;
  }
}

/// The way from the root to the tip, as far as it has been gone.
struct Walk {
  std::vector<MovingJoint> moving;
  std::vector<std::string> names;  ///< of the moving joints
  std::vector<PlacedLink> placed;
  AttachedFrame frame;  ///< of the link reached last
};

Walk walkFrom(int root, const UrdfTree& tree, const std::vector<int>& path) {
  Walk walk;
  walk.placed.push_back({root, walk.frame});
  for (const int j : path) {
    const JointReader reader{tree, tree.joints[j]};
    checkType(reader);
    walk.frame.X_JointFrame = walk.frame.X_JointFrame * reader.origin();
    if (reader.joint.type != "fixed") {
      walk.moving.push_back(readMovingJoint(reader));
      walk.moving.back().joint.X_ParentJoint = walk.frame.X_JointFrame;
      walk.names.push_back(reader.joint.name);
      walk.frame = {static_cast<int>(walk.moving.size()) - 1, Pose{}};
    }
    walk.placed.push_back({reader.joint.child, walk.frame});
  }
  return walk;
}

void checkJointCount(const Walk& walk, const std::string& root, const NamedFrame& tip) {
  if (walk.moving.size() >= 2 && walk.moving.size() <= kMaxJoints) return;
  failAt(tip.at, tip.key,
         fmt::format("{} moving joints from {} to {}", walk.moving.size(), inQuotes(root),
                     inQuotes(tip.link)),
         fmt::format("expected 2 to {}", kMaxJoints));
}

AttachedFrame moduleFrame(const UrdfTree& tree, const Walk& walk, const NamedFrame& link) {
  const AttachedFrame frame = frameBesideChain(tree, walk.placed, link);
  if (frame.joint < 0) {
    failAt(link.at, link.key, inQuotes(link.link) + " never moves",
           "expected a link that at least one joint moves");
  }
  return frame;
}

}  // namespace

UrdfChain loadUrdfChain(const SourceFile& file, const NamedFrame& tip,
                        const std::vector<NamedFrame>& module_links,
                        const std::vector<NamedFrame>& capsule_links) {
  UrdfTree tree;
  parseUrdf(file, tree);
  const int tip_link = requireLink(tree, tip);
  const std::vector<int> path = tree.pathTo(tip_link);
  const int root = path.empty() ? tip_link : tree.joints[path.front()].parent;
  const Walk walk = walkFrom(root, tree, path);
  checkJointCount(walk, tree.links[root], tip);

  UrdfChain chain;
  chain.links = walk.placed;
  chain.robot_name = tree.robot_name;
  chain.joint_names = walk.names;
  for (const MovingJoint& m : walk.moving) chain.joints.push_back(m.joint);
  chain.tip = walk.frame;
  setLimits(walk.moving, chain.limits);
  chain.max_effort.resize(static_cast<Eigen::Index>(walk.moving.size()));
  for (std::size_t i = 0; i < walk.moving.size(); ++i)
    chain.max_effort[static_cast<Eigen::Index>(i)] = walk.moving[i].max_effort;
  for (const NamedFrame& link : module_links)
    chain.module_links.push_back(moduleFrame(tree, walk, link));
  for (const NamedFrame& link : capsule_links)
    chain.capsule_links.push_back(frameBesideChain(tree, walk.placed, link));
  return chain;
}

}  // namespace tactus
