#include "tactus/sim/link_contacts.h"

#include <Eigen/Geometry>
#include <utility>

namespace tactus {
namespace {

/// As capsules meet it, from all sides.
ObstacleConfig asShape(ObstacleConfig config) {
  const bool is_vertical_line = !config.sphere && !config.plane && !config.line && !config.post;
  if (is_vertical_line)
    config.line = LineConfig{Vector3(config.x_m, config.y_m, 0.0), Vector3::UnitZ()};
  return config;
}

/// The frame in which the axis of a capsule is x.
Pose axisFrame(const LinkCapsule& capsule, double length_m) {
  const Vector3 x = length_m > 0.0 ? Vector3((capsule.p_LinkTo - capsule.p_LinkFrom) / length_m)
                                   : Vector3(Vector3::UnitX());
  Pose X;
  X.R_AB.col(0) = x;
  X.R_AB.col(1) = x.unitOrthogonal();
  X.R_AB.col(2) = x.cross(X.R_AB.col(1));
  X.p_AB = capsule.p_LinkFrom;
  return X;
}

ScaledVector torqueOf(const SerialChain& chain, const ChainPose& pose, int joint,
                      const Vector3& p_Base, const Vector3& force_Base) noexcept {
  ScaledVector torque;
  applyPointJacobianTranspose(chain, pose, joint, p_Base, force_Base, torque);
  return torque;
}

}  // namespace

LinkContacts::LinkContacts(const PlantConfig& plant, const ChainPose& pose)
    : obstacles_(static_cast<int>(plant.obstacles.size())) {
  for (const LinkCapsule& capsule : plant.capsules) {
    const double length_m = (capsule.p_LinkTo - capsule.p_LinkFrom).norm();
    const AttachedFrame frame{capsule.link.joint,
                              capsule.link.X_JointFrame * axisFrame(capsule, length_m)};
    Link& link =
        links_.emplace_back(Link{frame, length_m, capsule.radius_m, framePose(pose, frame), {}});
    for (const ObstacleConfig& obstacle : plant.obstacles)
      link.contacts.push_back({Obstacle(asShape(obstacle), plant.robot_stiffness_N_per_m), 0.0});
  }
}

void LinkContacts::touch(const SerialChain& chain, const ChainPose& pose, double t_s,
                         ScaledVector& torque, std::span<Vector3> slid_m) noexcept {
  for (int i = 0; i < capsules(); ++i) {
    Link& link = links_[i];
    const Pose X_BaseLink = framePose(pose, link.frame);
    const ModuleStep step{X_BaseLink, std::exchange(link.X_BaseLink, X_BaseLink)};
    const CoverAxis axis{X_BaseLink.p_AB, X_BaseLink.R_AB.col(0), link.length_m, link.radius_m};
    for (int k = 0; k < obstacles_; ++k) {
      Contact& contact = link.contacts[k];
      const ObstacleContact normal =
          contact.obstacle.touch(axis, t_s, slid_m.empty() ? nullptr : &slid_m[k]);
      ObstacleFriction friction;
      if (contact.obstacle.hasFriction()) friction = contact.obstacle.rub(step, axis, normal);
      contact.force_N = (normal.force_Base + friction.force_Base).norm();
      if (contact.force_N == 0.0) continue;
      if (contact.force_N > largest_.force_N) largest_ = {contact.force_N, i, k, t_s};
      const Vector3 p_BaseAxis = axis.p_BaseStart + normal.position_m * axis.direction;
      const Vector3 p_BaseSurface = X_BaseLink.p_AB + X_BaseLink.R_AB * friction.p_ModuleSurface;
      const int joint = link.frame.joint;
      torque += torqueOf(chain, pose, joint, p_BaseAxis, normal.force_Base);
      torque += torqueOf(chain, pose, joint, p_BaseSurface, friction.force_Base);
    }
  }
}

}  // namespace tactus
