#include "tactus/scene/urdf_capsules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tactus/scene/urdf_node.h"
#include "tactus/scene/yaml_word.h"

namespace tactus {
namespace {

constexpr double kMaxSize_m = 1e3;
constexpr double kShortest_m = 1e-3;  ///< shorter pieces of links are left out

/// In the frame of its link.
struct Capsule {
  Vector3 from, to;
  double radius_m;
};

std::string vectorText(const Vector3& v) {
  const auto text = [](double x) { return fmt::format("{:.4g}", std::abs(x) < 5e-5 ? 0.0 : x); };
  return fmt::format("[{}, {}, {}]", text(v.x()), text(v.y()), text(v.z()));
}

std::string lineOf(const std::string& link, const Capsule& capsule) {
  return fmt::format("  - {{link: {}, from_m: {}, to_m: {}, radius_m: {:.4g}}}\n", yamlWord(link),
                     vectorText(capsule.from), vectorText(capsule.to), capsule.radius_m);
}

/// Along an axis of a body's frame, with round ends within the length where that is long enough.
Capsule along(const Pose& X_LinkBody, int axis, double length_m, double radius_m) {
  const Vector3 half = std::max(0.0, 0.5 * length_m - radius_m) * X_LinkBody.R_AB.col(axis);
  return {X_LinkBody.p_AB - half, X_LinkBody.p_AB + half, radius_m};
}

double sizeOf(const UrdfNode& geometry, const char* shape, const char* key) {
  const double size_m = geometry.number(shape, key, kMaxSize_m, kRequired);
  if (size_m < 0.0)
    geometry.fail(geometry.child(shape), std::string(shape) + "." + key, "is negative",
                  "a number >= 0 in m");
  return size_m;
}

Capsule capsuleOfBox(const UrdfNode& geometry, const Pose& X_LinkBody) {
  const Vector3 size = geometry.vector("box", "size", kMaxSize_m, Vector3::Zero());
  if (size.minCoeff() < 0.0)
    geometry.fail(geometry.child("box"), "box.size", "is negative", "three numbers >= 0 in m");
  Eigen::Index longest;
  const double length_m = size.maxCoeff(&longest);
  const double width_m = std::max(size[(longest + 1) % 3], size[(longest + 2) % 3]);
  return along(X_LinkBody, static_cast<int>(longest), length_m, 0.5 * width_m);
}

/// Absent for meshes. Vendors mark a place by a shape without size: its radius is 0.
std::optional<Capsule> capsuleOf(const UrdfNode& collision) {
  const UrdfNode geometry{collision.tree, collision.child("geometry"), collision.key + ".geometry"};
  const Pose X_LinkBody = collision.origin();
  if (geometry.child("sphere"))
    return along(X_LinkBody, 0, 0.0, sizeOf(geometry, "sphere", "radius"));
  if (geometry.child("box")) return capsuleOfBox(geometry, X_LinkBody);
  const bool is_capsule = static_cast<bool>(geometry.child("capsule"));  // its ends are beyond it
  const char* const shape = is_capsule ? "capsule" : "cylinder";
  if (!geometry.child(shape)) return std::nullopt;
  const double length_m = sizeOf(geometry, shape, "length");
  const double radius_m = sizeOf(geometry, shape, "radius");
  return along(X_LinkBody, 2, length_m + (is_capsule ? 2.0 * radius_m : 0.0), radius_m);
}

/// Whether a link hangs on the arm's base or on what its joints move.
bool isOfArm(const UrdfTree& tree, const Scene& scene, int link) {
  while (tree.joint_above[link] >= 0) {
    const UrdfJoint& joint = tree.joints[tree.joint_above[link]];
    if (std::ranges::count(scene.joint_names, joint.name) > 0) return true;
    if (joint.type != "fixed") return false;
    link = joint.parent;
  }
  return true;
}

std::string ofCollisions(const UrdfTree& tree, const Scene& scene) {
  std::string text;
  int link = 0;  // in the order of the tree's
  for (const pugi::xml_node& node : tree.document.document_element().children("link")) {
    const std::string& name = tree.links[link];
    const bool is_of_arm = isOfArm(tree, scene, link++);
    const bool has_module = std::ranges::count(scene.module_links, name) > 0;
    for (const pugi::xml_node& child : node.children("collision")) {
      if (!is_of_arm) continue;
      const auto capsule = capsuleOf({tree, child, "link." + name + ".collision"});
      if (!capsule || capsule->radius_m == 0.0) {
        text += fmt::format("  # {}: {}, of which no capsule is made: measure it\n", escaped(name),
                            capsule ? "a shape without size" : "a mesh");
      } else if (has_module) {
        text +=
            fmt::format("  # {} has a tactile module: of this keep what its cover leaves free\n",
                        escaped(name)) +
            "  #" + lineOf(name, *capsule).substr(1);
      } else {
        text += lineOf(name, *capsule);
      }
    }
  }
  return text;
}

/// The link that a joint moves.
std::string linkBehind(const UrdfTree& tree, const std::string& joint) {
  const auto found = std::ranges::find(tree.joints, joint, &UrdfJoint::name);
  return tree.links[found->child];
}

/// What covers of modules take up of a straight link, from its joint on, m.
struct Covered {
  double from_m = kNoLimit, to_m = -kNoLimit;
};

Covered coveredOf(const Scene& scene, int joint, const Vector3& direction) {
  Covered covered;
  for (const TactileModuleConfig& module : scene.controller.tactile_modules) {
    if (module.link.joint != joint) continue;
    const Pose& X = module.link.X_JointFrame;
    for (const double x_m : {0.0, module.length_m}) {
      const double place_m = direction.dot(X.p_AB + x_m * X.R_AB.col(0));
      covered.from_m = std::min(covered.from_m, place_m);
      covered.to_m = std::max(covered.to_m, place_m);
    }
  }
  return covered;
}

double assumedRadius_m(const Scene& scene) {
  constexpr double kAssumed_m = 0.05;
  const auto& modules = scene.plant.modules;
  return modules.empty() ? kAssumed_m : modules.front().cover_radius_m;
}

std::string ofLengths(const UrdfTree& tree, const Scene& scene) {
  const ControllerConfig& config = scene.controller;
  const double radius_m = assumedRadius_m(scene);
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  std::string text;
  for (int i = 0; i < config.chain.size(); ++i) {
    const Vector3 p_BaseNext = i + 1 < config.chain.size()
                                   ? pose.p_BaseJoint[i + 1]
                                   : framePosition(pose, config.chain.tip());
    const Vector3 way = pose.R_BaseJoint[i].transpose() * (p_BaseNext - pose.p_BaseJoint[i]);
    const double length_m = way.norm();
    if (length_m < kShortest_m) continue;
    const Vector3 direction = way / length_m;
    const Covered covered = coveredOf(scene, i, direction);
    const auto add = [&](double from_m, double to_m) {
      if (to_m - from_m < kShortest_m) return;
      text += lineOf(linkBehind(tree, scene.joint_names[i]),
                     {from_m * direction, to_m * direction, radius_m});
    };
    add(0.0, std::min(length_m, covered.from_m));
    add(std::max(0.0, covered.to_m), covered.to_m > covered.from_m ? length_m : 0.0);
  }
  return text;
}

}  // namespace

std::string proposeCapsules(const Scene& scene) {
  UrdfTree tree;
  parseUrdf(scene.sources.back(), tree);
  const std::string name = escaped(scene.sources.back().path);
  const std::string of_collisions = ofCollisions(tree, scene);
  std::string text = "# For robot.yaml. ";
  if (of_collisions.empty()) {
    text += name +
            " has no collision geometry of links: these are the straight ways from\n"
            "# joint to joint at the scene's start, less the covers of modules. The radius is an "
            "assumption:\n# measure it.\n";
  } else {
    text += "From the collision geometry of " + name + "; edges are rounded: look at each.\n";
  }
  if (scene.controller.tactile_modules.empty() && !scene.plant.modules.empty())
    text += "# This scene reads no tactile module: leave out what covers take up.\n";
  const std::string list = of_collisions.empty() ? ofLengths(tree, scene) : of_collisions;
  const bool has_some = list.starts_with("  - ") || list.find("\n  - ") != std::string::npos;
  return text + (has_some ? "" : "# ") + "collision_capsules:\n" + list;  // a list is never empty
}

}  // namespace tactus
