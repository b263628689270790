#include "tactus/run/touch_check.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "tactus/analysis/contact_peak.h"
#include "tactus/analysis/effective_mass.h"
#include "tactus/analysis/variant_loops.h"
#include "tactus/run/held_touch.h"
#include "tactus/scene/dynamics_loader.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

constexpr double kLeastFriction = 0.05;  ///< of obstacles: less adds a tenth to a force at most

/// At which the speed of the touch is taken off, N. Where nothing else does it than a feedforward
/// that engages with the force, that is whole F_eng above F_th.
double answeredForce_N(const ControllerConfig& config) {
  const ForceGains& gains = config.gains.force;
  const bool has_more = hasActivationForce(config.force_control->variant);
  return gains.contact_threshold_N + (has_more ? 0.0 : gains.transition.engage_force_N);
}

/// A touch of this spring by the scene's arm, whose loop of one space has its delays.
TouchedSpring touchedSpring(const Scene& scene, int module, const ObstacleConfig& obstacle,
                            double robot_stiffness_N_per_m) {
  return {variantLoops(scene.controller, scene.plant, scene.period_s, module).front().loop,
          answeredForce_N(scene.controller), ContactSpring(obstacle, robot_stiffness_N_per_m)};
}

/// F_act + F_th where the law keeps to it, else half of the peak.
std::optional<SofterTouch> softerTouch(const Scene& scene, const TouchedSpring& touched,
                                       double speed_m_per_s, double peak_N) {
  const ForceGains& gains = scene.controller.gains.force;
  SofterTouch softer{0.5 * peak_N, 0.0, {}};
  if (hasActivationForce(scene.controller.force_control->variant))
    softer.force_N = gains.activation_force_N + gains.contact_threshold_N;
  if (peak_N <= softer.force_N) return std::nullopt;
  softer.speed_m_per_s = touchSpeed_m_per_s(touched, softer.force_N);
  if (softer.speed_m_per_s <= 0.0) return std::nullopt;
  softer.cutoff_hz = touchCutoff_hz(touched, speed_m_per_s, softer.force_N);
  return softer;
}

std::vector<TouchReport> touchesOf(const Scene& scene, const PathContacts& contacts) {
  std::vector<TouchReport> reports;
  for (std::size_t i = 0; i < contacts.touches.size(); ++i) {
    const std::optional<PathTouch>& touch = contacts.touches[i];
    if (!touch || touch->t_s == 0.0) continue;
    const TouchedSpring touched = touchedSpring(scene, touch->module, scene.plant.obstacles[i],
                                                scene.plant.robot_stiffness_N_per_m);
    // One that appears in the arm pushes at once, however slow that is, or if it rests.
    const bool comes = touch->speed_m_per_s > 0.0;
    const double approach_N = comes ? touchPeak_N(touched, touch->speed_m_per_s) : 0.0;
    const double at_once_N = touched.spring.force_N(touch->depth_m);
    if (!comes && at_once_N <= touched.threshold_N) continue;
    const double peak_N = pushOf_N(scene.plant.obstacles[i], std::max(approach_N, at_once_N));
    TouchReport report{static_cast<int>(i), *touch, peak_N, {}};
    if (approach_N >= at_once_N)
      report.softer = softerTouch(scene, touched, touch->speed_m_per_s, peak_N);
    reports.push_back(report);
  }
  return reports;
}

/// The stiffness that a blow meets: c_e has the whole arm in it, whose gears do not matter to it.
double blowStiffness(const Scene& scene, double stiffest_N_per_m) {
  return std::max(stiffest_N_per_m, stiffestBeforeGears(scene));
}

double massAt(const Scene& scene, const FastestCover& fastest) {
  const ControllerConfig& config = scene.controller;
  const ArmDescription& arm = *scene.arm;
  ChainPose pose;
  config.chain.computePose(fastest.q, pose);
  return effectiveMass_kg(config.chain, pose,
                          massMatrixAt(config.chain, arm.dynamics.bodies, fastest.q),
                          rotorsOfLinks(arm), config.tactile_modules[fastest.module].link.joint,
                          fastest.p_Base, fastest.direction);
}

PeakReport peakOf(const Scene& scene, const FastestCover& fastest, double stiffest_N_per_m) {
  const ForceGains& gains = scene.controller.gains.force;
  const double v = fastest.speed_m_per_s;
  ObstacleConfig stiffest;
  stiffest.stiffness_N_per_m = stiffest_N_per_m;
  const TouchedSpring touched = touchedSpring(scene, fastest.module, stiffest, kNoLimit);
  PeakReport report{.fastest = fastest,
                    .stiffness_N_per_m = stiffest_N_per_m,
                    .delay_s = touchDelay_s(touched, v),
                    .delay_peak_N = touchPeak_N(touched, v),
                    .mass_kg = {},
                    .blow_peak_N = {},
                    .max_force_N = scene.controller.tactile_modules[fastest.module].max_force_N,
                    .target_N = 0.0,
                    .target_speed_m_per_s = 0.0};
  const bool has_activation = hasActivationForce(scene.controller.force_control->variant);
  report.target_N =
      has_activation ? gains.activation_force_N + gains.contact_threshold_N : report.max_force_N;
  report.target_speed_m_per_s = touchSpeed_m_per_s(touched, report.target_N);
  if (!scene.arm) return report;
  report.mass_kg = massAt(scene, fastest);
  const double k = blowStiffness(scene, stiffest_N_per_m);
  report.blow_peak_N = blowPeak_N(v, k, *report.mass_kg);
  report.target_speed_m_per_s =
      std::min(report.target_speed_m_per_s, report.target_N / blowPeak_N(1.0, k, *report.mass_kg));
  return report;
}

/// Of the modules the one that may come nearest to what its sensor can show.
std::optional<PeakReport> worstPeak(const Scene& scene, const PathContacts& contacts,
                                    double stiffest_N_per_m) {
  std::optional<PeakReport> worst;
  for (const FastestCover& fastest : contacts.fastest) {
    if (fastest.speed_m_per_s <= 0.0) continue;
    const PeakReport peak = peakOf(scene, fastest, stiffest_N_per_m);
    if (!worst || peak.shareOfRange() > worst->shareOfRange()) worst = peak;
  }
  return worst;
}

/// Across its axis: the way in which the joints move a cover's middle best, and the one in which
/// they do worst. As columns, base frame.
Eigen::Matrix<double, 3, 2> waysAcross(const ControllerConfig& config, const ChainPose& pose,
                                       const FastestCover& cover, const Pose& X_BaseModule) {
  const Eigen::Matrix<double, 3, 2> across = X_BaseModule.R_AB.rightCols<2>();
  const int joints = config.chain.size();
  Eigen::MatrixXd speeds(joints, 2);  // of the joints at their largest, m/s
  for (int k = 0; k < 2; ++k) {
    ScaledVector a;
    applyPointJacobianTranspose(config.chain, pose, config.tactile_modules[cover.module].link.joint,
                                cover.p_Base, across.col(k), a);
    speeds.col(k) = a.head(joints).cwiseProduct(config.limits.max_velocity);
  }
  const Eigen::Matrix2d gram = speeds.transpose() * speeds;
  return across * Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(gram).eigenvectors();
}

/// With all joints at their largest speeds, m/s.
double reachableSpeed(const ControllerConfig& config, const ChainPose& pose,
                      const FastestCover& cover) {
  ScaledVector a;
  applyPointJacobianTranspose(config.chain, pose, config.tactile_modules[cover.module].link.joint,
                              cover.p_Base, cover.direction, a);
  return a.head(config.chain.size()).cwiseAbs().dot(config.limits.max_velocity);
}

/// Where a tool that is told leads the arm is not known: a cover may be as fast as it, wherever the
/// joints can move it so. Of such ways the one with the most mass.
FastestCover assumedFastest(const Scene& scene, int module) {
  constexpr double kAtRest_m_per_s = 1e-6;
  const ControllerConfig& config = scene.controller;
  const TactileModuleConfig& read = config.tactile_modules[module];
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  const Pose X_BaseModule = framePose(pose, read.link);
  FastestCover cover{.module = module, .q = config.q_start};
  cover.p_Base = X_BaseModule.p_AB + 0.5 * read.length_m * X_BaseModule.R_AB.col(0);
  const Eigen::Matrix<double, 3, 2> ways = waysAcross(config, pose, cover, X_BaseModule);
  FastestCover fastest = cover;
  double most_kg = 0.0;
  for (int k = 0; k < 2; ++k) {
    cover.direction = ways.col(k);
    cover.speed_m_per_s = std::min(config.task.commands->limits.position.max_speed,
                                   reachableSpeed(config, pose, cover));
    if (cover.speed_m_per_s < std::max(kAtRest_m_per_s, fastest.speed_m_per_s)) continue;
    const double mass_kg = scene.arm ? massAt(scene, cover) : 0.0;
    if (cover.speed_m_per_s == fastest.speed_m_per_s && mass_kg < most_kg) continue;
    fastest = cover;
    most_kg = mass_kg;
  }
  return fastest;
}

MovingObstacle bearableMotion(const ForceGains& gains, double stiffest_N_per_m) {
  const double m = std::max(stiffest_N_per_m, gains.min_approach_stiffness_N_per_m);
  const double limit_N = gains.activation_force_N + gains.contact_threshold_N;
  return {m, limit_N / (2.0 * gains.time_constant_s * m), 1.5 * limit_N};
}

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
    const double max_force_N = scene.controller.tactile_modules[module].max_force_N;
    if (report.peak_N <= max_force_N) continue;
    warnings.push_back(
        fmt::format("the touch of obstacle {}{} may come to {:.3g} N, the sensor's max_force_N is "
                    "{:g}: that ends in a fault",
                    report.obstacle, ofModule(scene, module), report.peak_N, max_force_N));
  }
}

std::vector<std::string> warningsOf(const Scene& scene, const PathContacts& contacts,
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
  warnOfFriction(scene, warnings);
  for (const CapsuleTouch& touch : contacts.unsensed)
    if (!isFeltBefore(scene, contacts, touch)) warnings.push_back(unsensedWarning(scene, touch));
  for (const std::string& warning : heldTouches(scene, contacts)) warnings.push_back(warning);
  warnOfHardTouches(scene, report.touches, warnings);
  if (peak && peak->peak_N() > peak->max_force_N) {
    warnings.push_back(
        fmt::format("the stiffest contact{} may come to {:.3g} N, the sensor's max_force_N is "
                    "{:g}: that ends in a fault",
                    ofModule(scene, peak->fastest.module), peak->peak_N(), peak->max_force_N));
  }
  return warnings;
}

}  // namespace

double PeakReport::peak_N() const { return std::max(delay_peak_N, blow_peak_N.value_or(0.0)); }

ExpectedContact checkContacts(const Scene& scene, double stiffest_N_per_m) {
  ExpectedContact report;
  if (scene.controller.tactile_modules.empty() && scene.plant.capsules.empty()) return report;
  PathContacts contacts =
      followPath(scene.controller, scene.plant, scene.period_s, scene.duration_s);
  for (std::size_t i = 0; scene.controller.task.commands && i < contacts.fastest.size(); ++i)
    contacts.fastest[i] = assumedFastest(scene, static_cast<int>(i));
  if (scene.controller.force_control) {
    report.touches = touchesOf(scene, contacts);
    report.peak = worstPeak(scene, contacts, stiffest_N_per_m);
    if (scene.controller.force_control->variant == Variant::kNullLimit)
      report.moving = bearableMotion(scene.controller.gains.force, stiffest_N_per_m);
  }
  report.warnings = warningsOf(scene, contacts, report);
  return report;
}

}  // namespace tactus
