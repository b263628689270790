#include "tactus/run/touch_check.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "tactus/analysis/contact_peak.h"
#include "tactus/analysis/effective_mass.h"
#include "tactus/analysis/variant_loops.h"
#include "tactus/run/sensor_range.h"
#include "tactus/run/touch_warnings.h"
#include "tactus/scene/dynamics_loader.h"
#include "tactus/scene/judged_plant.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

/// At which the speed of the touch is taken off, N. Where nothing else does it than a feedforward
/// that engages with the force, that is whole F_eng above F_th.
double answeredForce_N(const ControllerConfig& config) {
  const ForceGains& gains = config.gains.force;
  const bool has_more = hasActivationForce(config.force_control->variant);
  return gains.contact_threshold_N + (has_more ? 0.0 : gains.transition.engage_force_N);
}

/// A touch of this spring by the scene's arm, whose loop of one space has its delays.
TouchedSpring touchedSpring(const Scene& scene, const PlantConfig& plant, int module,
                            const ObstacleConfig& obstacle, double robot_stiffness_N_per_m) {
  return {variantLoops(scene.controller, plant, scene.period_s, module).front().loop,
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
    const TouchedSpring touched =
        touchedSpring(scene, scene.plant, touch->module, scene.plant.obstacles[i],
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

/// Of no obstacle of the simulation, so of the delays that the daemon's arm has, as the margins.
PeakReport peakOf(const Scene& scene, const FastestCover& fastest, double stiffest_N_per_m) {
  const ForceGains& gains = scene.controller.gains.force;
  const double v = fastest.speed_m_per_s;
  ObstacleConfig stiffest;
  stiffest.stiffness_N_per_m = stiffest_N_per_m;
  const TouchedSpring touched =
      touchedSpring(scene, judgedPlant(scene), fastest.module, stiffest, kNoLimit);
  PeakReport report{.fastest = fastest,
                    .stiffness_N_per_m = stiffest_N_per_m,
                    .delay_s = touchDelay_s(touched, v),
                    .delay_peak_N = touchPeak_N(touched, v),
                    .mass_kg = {},
                    .blow_peak_N = {},
                    .sensor_N = sensorRange(scene, fastest.module).force_N,
                    .target_N = 0.0,
                    .target_speed_m_per_s = 0.0};
  const bool has_activation = hasActivationForce(scene.controller.force_control->variant);
  report.target_N =
      has_activation ? gains.activation_force_N + gains.contact_threshold_N : report.sensor_N;
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
  report.warnings = touchWarnings(scene, contacts, report);
  return report;
}

}  // namespace tactus
