#include "tactus/scene/urdf_bodies.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "tactus/scene/urdf_node.h"

namespace tactus {
namespace {

constexpr double kMaxMass_kg = 1e5;
constexpr double kMaxInertia_kgm2 = 1e6;

/// A body's principal moments are sums of squares along two axes each, so none is larger than the
/// other two together. Descriptions round, and so do eigenvalues: a thin rod has one of zero.
bool isOfABody(const Matrix3& I) {
  constexpr double kRounding = 1e-3;
  const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(I).eigenvalues();
  return moments[0] >= -kRounding * moments[2] &&
         moments[2] <= (moments[0] + moments[1]) * (1.0 + kRounding);
}

Matrix3 readInertia(const UrdfNode& inertial) {
  const auto entry = [&](const char* name) {
    return inertial.number("inertia", name, kMaxInertia_kgm2, kRequired);
  };
  // One by one: Eigen's comma initializer asserts when one of them throws.
  Matrix3 I;
  I(0, 0) = entry("ixx");
  I(0, 1) = I(1, 0) = entry("ixy");
  I(0, 2) = I(2, 0) = entry("ixz");
  I(1, 1) = entry("iyy");
  I(1, 2) = I(2, 1) = entry("iyz");
  I(2, 2) = entry("izz");
  if (!isOfABody(I)) {
    inertial.fail(inertial.child("inertia"), "inertia", "no body has these moments",
                  "principal moments >= 0, none above the sum of the other two");
  }
  return I;
}

/// In the frame of its link.
BodyInertia readBody(const UrdfNode& inertial) {
  BodyInertia body;
  body.mass_kg = inertial.number("mass", "value", kMaxMass_kg, kRequired);
  if (body.mass_kg < 0.0)
    inertial.fail(inertial.child("mass"), "mass.value", "is negative", "a mass >= 0 in kg");
  body.I_Com = readInertia(inertial);
  return transformed(inertial.origin(), body);
}

/// Of any link, by the moving joint of the chain that it goes with.
AttachedFrame placeOf(const UrdfTree& tree, const UrdfChain& chain, int link) {
  Pose X_LinkFrame;
  while (true) {
    const auto on_chain = std::ranges::find(chain.links, link, &PlacedLink::link);
    if (on_chain != chain.links.end())
      return {on_chain->frame.joint, on_chain->frame.X_JointFrame * X_LinkFrame};
    const UrdfJoint& joint = tree.joints[tree.joint_above[link]];
    const UrdfNode reader{tree, joint.node, "joint." + joint.name};
    X_LinkFrame = reader.origin() * X_LinkFrame;
    link = joint.parent;
  }
}

}  // namespace

std::vector<BodyInertia> loadUrdfBodies(const SourceFile& file, const UrdfChain& chain) {
  UrdfTree tree;
  parseUrdf(file, tree);
  std::vector<BodyInertia> bodies(chain.joints.size());
  int link = 0;  // in the order of the tree's
  for (const pugi::xml_node& node : tree.document.document_element().children("link")) {
    const AttachedFrame place = placeOf(tree, chain, link);
    const std::string key = "link." + tree.links[link++];
    const pugi::xml_node inertial = onlyChild(tree, node, "inertial", key);
    if (!inertial || place.joint < 0) continue;
    const BodyInertia body = readBody({tree, inertial, key + ".inertial"});
    bodies[place.joint] = combined(bodies[place.joint], transformed(place.X_JointFrame, body));
  }
  return bodies;
}

}  // namespace tactus
