#include "tactus/run/held_touch.h"

#include <fmt/format.h>

#include <cmath>

#include "tactus/analysis/contact_at_pose.h"
#include "tactus/analysis/contact_peak.h"
#include "tactus/scene/key_words.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

constexpr double kMostWay = 1.0;        ///< of the joints, rad or m, weighted
constexpr double kMattersFrom_N = 2.0;  ///< above the law's threshold

/// Of the only space that the law answers in; absent where there is another.
std::optional<double> kOfLaw(Variant variant, const ContactSpace& space) {
  if (variant == Variant::kNullSpace) return space.k_n;
  if (variant == Variant::kTaskSpace) return space.k_t;
  if (variant == Variant::kJointSpace) return space.k_j;
  return std::nullopt;
}

ContactSpace spaceAt(const ControllerConfig& config, const PathTouch& touch) {
  ChainPose pose;
  config.chain.computePose(touch.q, pose);
  ScaledVector a;
  applyPointJacobianTranspose(config.chain, pose, config.tactile_modules[touch.module].link.joint,
                              touch.p_Base, touch.normal_Base, a);
  return contactAtPose(config, pose, a).space;
}

}  // namespace

std::vector<std::string> heldTouches(const Scene& scene, const PathContacts& contacts) {
  std::vector<std::string> warnings;
  if (!scene.controller.force_control) return warnings;
  const Variant variant = scene.controller.force_control->variant;
  const double threshold_N = scene.controller.gains.force.contact_threshold_N;
  for (std::size_t i = 0; i < contacts.touches.size(); ++i) {
    const std::optional<PathTouch>& touch = contacts.touches[i];
    if (!touch || touch->t_s == 0.0) continue;
    const std::optional<double> k = kOfLaw(variant, spaceAt(scene.controller, *touch));
    if (!k || touch->deepest_m <= kMostWay * std::sqrt(*k)) continue;
    const ObstacleConfig& obstacle = scene.plant.obstacles[i];
    const ContactSpring spring(obstacle, scene.plant.robot_stiffness_N_per_m);
    const double force_N = pushOf_N(obstacle, spring.force_N(touch->deepest_m));
    if (force_N <= threshold_N + kMattersFrom_N) continue;
    warnings.push_back(fmt::format(
        "obstacle {}{} gets {:.3g} mm into the path, and {} moves the cover there by {:.1f} mm a "
        "rad or m of the joints: no room to give way, it may come to {:.3g} N",
        i, ofModule(scene, touch->module), 1e3 * touch->deepest_m, wordOf(kVariantWords, variant),
        1e3 * std::sqrt(*k), force_N));
  }
  return warnings;
}

}  // namespace tactus
