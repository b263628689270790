#include "tactus/run/touch_warnings.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactus/analysis/contact_peak.h"
#include "tactus/run/held_touch.h"
#include "tactus/run/sensor_range.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

constexpr double kLeastFriction = 0.05;  ///< of obstacles: less adds a tenth to a force at most

/// Whether a cover comes to this obstacle first, and the law gives way to it.
bool isFeltBefore(const Scene& scene, const PathContacts& contacts, const CapsuleTouch& unsensed) {
  const std::optional<PathTouch>& touch = contacts.touches[unsensed.obstacle];
  return scene.controller.force_control && touch && touch->t_s < unsensed.t_s;
}

/// Of an arm that follows its path and does not give way.
std::string unsensedWarning(const Scene& scene, const CapsuleTouch& touch) {
  const ObstacleConfig& obstacle = scene.plant.obstacles[touch.obstacle];
  const ContactSpring spring(obstacle, scene.plant.robot_stiffness_N_per_m);
  const std::string& link = scene.capsule_links[touch.capsule];
  const double force_N = pushOf_N(obstacle, spring.force_N(touch.deepest_m));
  const std::string force = fmt::format("about {:.3g} N", force_N);
  if (touch.t_s == 0.0) {
    return fmt::format("{} touches obstacle {} unsensed at the start, {:.3g} mm deep, {}", link,
                       touch.obstacle, 1e3 * touch.depth_m, force);
  }
  return fmt::format("{} touches obstacle {} unsensed at t = {:.3g} s, {}", link, touch.obstacle,
                     touch.t_s, force);
}

/// Whether it is on its path while this obstacle is there: one that has given way to another no
/// longer is.
bool isOnPath(const Scene& scene, const PathContacts& contacts, const ObstacleConfig& obstacle) {
  if (!scene.controller.force_control) return true;
  return std::ranges::none_of(contacts.touches, [&](const std::optional<PathTouch>& touch) {
    return touch && touch->t_s < obstacle.appears_s;
  });
}

/// Friction tilts the force that is felt, so that the way back slides along the cover, which tilts
/// it anew; see docs/approach_speed_limit.md. A module that feels M_x knows the normal.
void warnOfFriction(const Scene& scene, std::vector<std::string>& warnings) {
  const std::optional<ForceControlConfig>& law = scene.controller.force_control;
  const auto feelsNormal = [](const TactileModuleConfig& module) { return module.feels_moment_x; };
  if (!law || std::ranges::all_of(scene.controller.tactile_modules, feelsNormal)) return;
  const std::vector<ObstacleConfig>& obstacles = scene.plant.obstacles;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const double mu = obstacles[i].friction_coefficient;
    if (mu < kLeastFriction || mu < law->friction_coefficient) continue;
    warnings.push_back(fmt::format(
        "obstacle {} has a friction of {:g}, which controller.friction_coefficient of null_limit "
        "has to exceed, and is {:g}: a stiff contact may swing and push many times as hard",
        i, mu, law->friction_coefficient));
  }
}

/// Of the first touches, as of an obstacle that comes in over an end of the cover.
void warnOfHardTouches(const Scene& scene, const std::vector<TouchReport>& touches,
                       std::vector<std::string>& warnings) {
  for (const TouchReport& report : touches) {
    const int module = report.touch.module;
    const SensorRange range = sensorRange(scene, module);
    if (report.peak_N <= range.force_N) continue;
    warnings.push_back(
        fmt::format("the touch of obstacle {}{} may come to {:.3g} N, {}: that ends in a fault",
                    report.obstacle, ofModule(scene, module), report.peak_N, range.text()));
  }
}

/// Where a tool is told to go there is no path to follow.
void warnOfRest(const Scene& scene, const PathContacts& contacts,
                std::vector<std::string>& warnings) {
  if (contacts.is_complete || scene.plant.obstacles.empty() || scene.controller.task.commands)
    return;
  warnings.push_back(fmt::format("only the first {:g} s of the run were searched for touches",
                                 kMaxFollowedCycles * scene.period_s));
}

}  // namespace

std::vector<std::string> touchWarnings(const Scene& scene, const PathContacts& contacts,
                                       const ExpectedContact& report) {
  const std::optional<PeakReport>& peak = report.peak;
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < contacts.touches.size(); ++i) {
    const std::optional<PathTouch>& touch = contacts.touches[i];
    if (!touch && contacts.is_complete && !scene.controller.tactile_modules.empty() &&
        !scene.controller.task.commands && isOnPath(scene, contacts, scene.plant.obstacles[i])) {
      warnings.push_back(
          fmt::format("obstacle {} is never touched: no cover comes to it on the scene's path", i));
    }
    if (touch && touch->t_s == 0.0) {
      warnings.push_back(
          fmt::format("obstacle {} is touched at the start, {:.3g} mm deep in the cover of {}", i,
                      1e3 * touch->depth_m, scene.module_links[touch->module]));
    }
  }
  warnOfRest(scene, contacts, warnings);
  warnOfFriction(scene, warnings);
  for (const CapsuleTouch& touch : contacts.unsensed)
    if (!isFeltBefore(scene, contacts, touch)) warnings.push_back(unsensedWarning(scene, touch));
  for (const std::string& warning : heldTouches(scene, contacts)) warnings.push_back(warning);
  warnOfHardTouches(scene, report.touches, warnings);
  if (peak && peak->peak_N() > peak->sensor_N) {
    const int module = peak->fastest.module;
    warnings.push_back(
        fmt::format("the stiffest contact{} may come to {:.3g} N, {}: that ends in a fault",
                    ofModule(scene, module), peak->peak_N(), sensorRange(scene, module).text()));
  }
  return warnings;
}

}  // namespace tactus
