#include "tactus/run/arm_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

using Warnings = std::vector<std::string>;

constexpr double kLongestLink_m = 20.0;  ///< longer ones are a URDF in mm, or in cm
constexpr double kShortestArm_m = 0.02;  ///< a URDF in km, or one that was scaled twice
constexpr double kWidestLimit_rad = 8.0 * std::numbers::pi;  ///< four turns; wrists have two
constexpr double kMostUnequal = 100.0;                       ///< of weights
constexpr double kMostOff = 0.1;        ///< of a cover's mass and of its filter
constexpr double kLightCover_kg = 0.1;  ///< with which no law swings
constexpr double kMostOffLink = 0.75;   ///< of a cover; one leg of a bent link stays below 0.71

ChainPose poseAtStart(const Scene& scene) {
  ChainPose pose;
  scene.controller.chain.computePose(scene.controller.q_start, pose);
  return pose;
}

void checkSizes(const Scene& scene, Warnings& warnings) {
  const ArmLengths lengths = armLengths(scene.controller.chain, poseAtStart(scene));
  if (lengths.longest_m > kLongestLink_m) {
    warnings.push_back(fmt::format(
        "the link behind joint {} is {:.4g} m long, which no robot's is: is the URDF in mm? it "
        "has to be in m",
        scene.joint_names[lengths.longest_joint], lengths.longest_m));
  }
  if (lengths.all_m < kShortestArm_m) {
    warnings.push_back(
        fmt::format("the whole arm is {:.3g} mm long, which no robot's is: a URDF has to be in m",
                    1e3 * lengths.all_m));
  }
}

/// Thresholds of damping and of regularised gains are lengths in the metric of W.
void checkWeights(const Scene& scene, Warnings& warnings) {
  const JointVector& weights = scene.controller.weights;
  const double ratio = weights.maxCoeff() / weights.minCoeff();
  if (ratio <= kMostUnequal * (1.0 + 1e-9)) return;
  warnings.push_back(fmt::format(
      "redundancy.weights: the largest is {:.3g} times the smallest: beyond {:g} the tool may lag "
      "as near a singular pose, and contacts may rest above F_act + F_th",
      ratio, kMostUnequal));
}

/// Infinite limits are those of joints without an end: no unit was taken for another there.
void checkJointLimits(const Scene& scene, Warnings& warnings) {
  const ControllerConfig& config = scene.controller;
  Warnings joints;
  for (int i = 0; i < config.chain.size(); ++i) {
    if (config.chain.type(i) != JointType::kRevolute) continue;
    const double lower = config.limits.lower[i], upper = config.limits.upper[i];
    const auto is_too_wide = [](double end) {
      return std::isfinite(end) && std::abs(end) > kWidestLimit_rad;
    };
    if (!is_too_wide(lower) && !is_too_wide(upper)) continue;
    joints.push_back(fmt::format("{} from {:g} to {:g}", scene.joint_names[i], lower, upper));
  }
  if (joints.empty()) return;
  warnings.push_back(fmt::format(
      "limits of joints more than four turns from zero: are they in degrees? a URDF has them in "
      "rad, and speeds in rad/s: {}",
      fmt::join(joints, ", ")));
}

void checkCovers(const Scene& scene, Warnings& warnings) {
  const ChainPose pose = poseAtStart(scene);
  const ControllerConfig& config = scene.controller;
  for (std::size_t i = 0; i < config.tactile_modules.size(); ++i) {
    const TactileModuleConfig& module = config.tactile_modules[i];
    const double share = shareOffLink(config.chain, pose, module);
    if (share <= kMostOffLink) continue;
    const CoverEnds ends = coverEnds(pose, module);
    warnings.push_back(fmt::format(
        "the cover leaves its link: the x axis of {} leads {:.0f} mm away from the line to the "
        "next joint, as if it lay across the link or ended before it; x has to point along it",
        scene.module_links[i], 1e3 * share * (ends.p_BaseEnd - ends.p_BaseStart).norm()));
  }
}

double massOf(const std::optional<CoverConfig>& cover) { return cover ? cover->mass_kg : 0.0; }

/// What is left of the inertia of a simulated cover moves the arm, and that the cover.
void checkCoverLoads(const Scene& scene, Warnings& warnings) {
  if (!scene.controller.force_control) return;
  for (std::size_t i = 0; i < scene.controller.tactile_modules.size(); ++i) {
    const TactileModuleConfig& read = scene.controller.tactile_modules[i];
    const SimulatedModuleConfig& module = scene.plant.modules[i];
    const double taken_kg = massOf(read.cover), simulated_kg = massOf(module.cover);
    const double most_off_kg = std::max(kLightCover_kg, kMostOff * taken_kg);
    const double most_off_hz = taken_kg > 0.0 ? kMostOff * read.filter_cutoff_hz : kNoLimit;
    if (std::abs(taken_kg - simulated_kg) <= most_off_kg &&
        std::abs(module.filter_cutoff_hz - read.filter_cutoff_hz) <= most_off_hz)
      continue;
    warnings.push_back(fmt::format(
        "the cover of {} is simulated with {:g} kg and a filter of {:g} Hz, but taken out of the "
        "readings with {:g} kg and {:g} Hz, as robot.yaml has them: what is left of its inertia "
        "may swing",
        scene.module_links[i], simulated_kg, module.filter_cutoff_hz, taken_kg,
        read.filter_cutoff_hz));
  }
}

/// Motors move where links no longer do.
void checkCoversBehindGears(const Scene& scene, Warnings& warnings) {
  const ControllerConfig& config = scene.controller;
  const bool is_flexible =
      scene.plant.dynamics && scene.plant.dynamics->gear_stiffness.minCoeff() < kNoLimit;
  if (!config.force_control || !is_flexible || scene.plant.drives.reports_links) return;
  if (config.geared_links) return;
  Warnings links;
  for (std::size_t i = 0; i < config.tactile_modules.size(); ++i)
    if (massOf(config.tactile_modules[i].cover) > 0.0) links.push_back(scene.module_links[i]);
  if (links.empty()) return;
  warnings.push_back(fmt::format(
      "flexible gears are simulated, but covers taken out of the readings as if the drives "
      "measured the links, which may swing: cover.behind_gears is not true of {}",
      fmt::join(links, ", ")));
}

/// A joint that speeds up alone: together they may need more, never all of them less.
void checkEfforts(const Scene& scene, Warnings& warnings) {
  if (!scene.arm) return;
  const ControllerConfig& config = scene.controller;
  const ArmDynamicsConfig& arm = scene.arm->dynamics;
  const MassMatrix M = massMatrixAt(config.chain, arm.bodies, config.q_start);
  Warnings joints;
  for (int i = 0; i < config.chain.size(); ++i) {
    const double inertia = M(i, i) + arm.rotor_inertia[i];
    const double effort = scene.arm->max_effort[i];
    const double acceleration = config.limits.max_acceleration[i];
    if (!(acceleration < kNoLimit) || !(inertia * acceleration > effort)) continue;
    const bool is_prismatic = config.chain.type(i) == JointType::kPrismatic;
    joints.push_back(fmt::format("{} needs {:.3g} of {:g} {} (at most {:.3g} {})",
                                 scene.joint_names[i], inertia * acceleration, effort,
                                 is_prismatic ? "N" : "Nm", effort / inertia,
                                 is_prismatic ? "m/s^2" : "rad/s^2"));
  }
  if (joints.empty()) return;
  warnings.push_back(fmt::format("limits.acceleration asks for more than the URDF's effort: {}",
                                 fmt::join(joints, ", ")));
}

/// Without an integral a drive keeps an error that only tracking takes away.
void checkDrives(const Scene& scene, Warnings& warnings) {
  if (!scene.arm || scene.arm->dynamics.servo_integral_hz > 0.0) return;
  Warnings joints;
  if (!scene.hardware) joints = scene.joint_names;
  if (scene.hardware) {
    for (const DriveConfig& drive : scene.hardware->drives)
      if (drive.tracking_gain_per_s == 0.0) joints.push_back(scene.joint_names[drive.joint]);
  }
  if (joints.empty()) return;
  warnings.push_back(fmt::format(
      "drives without an integral part (dynamics.servo_integral_hz) and without "
      "tracking_gain_per_s give way for good under load, so that the tool leaves its path: {}",
      fmt::join(joints, " ")));
}

/// Two costs end somewhere between them.
void checkPosture(const Scene& scene, Warnings& warnings) {
  const ControllerConfig& config = scene.controller;
  if (!config.q_posture) return;
  const JointLimitAvoidanceGains& gains = config.gains.joint_limit_avoidance;
  Warnings joints;
  double most = 1.0;
  for (int i = 0; i < config.chain.size(); ++i) {
    const double lower = config.limits.lower[i], upper = config.limits.upper[i];
    if (!std::isfinite(upper - lower) || upper == lower) continue;
    const double q = (*config.q_posture)[i];
    const double left = 2.0 * std::min(q - lower, upper - q) / (upper - lower);
    if (left >= gains.active_fraction) continue;
    joints.push_back(scene.joint_names[i]);
    most = std::min(most, left);
  }
  if (gains.gain == 0.0) {
    warnings.emplace_back(
        "redundancy.posture may press joints against their limits, and drag the tool along: the "
        "gain "
        "of joint_limit_avoidance is 0");
  } else if (!joints.empty()) {
    const std::string way_out =
        most < 0.01 ? "it has to be further inside their limits"
                    : fmt::format("with an active_fraction below {:.2f} it does not",
                                  std::floor(100.0 * most) / 100.0);
    warnings.push_back(
        fmt::format("redundancy.posture is not reached, as joint_limit_avoidance drives joints "
                    "away from there; {}: {}",
                    way_out, fmt::join(joints, " ")));
  }
}

}  // namespace

std::vector<CoverReport> coversAtStart(const Scene& scene) {
  const ChainPose pose = poseAtStart(scene);
  std::vector<CoverReport> covers;
  for (std::size_t i = 0; i < scene.controller.tactile_modules.size(); ++i)
    covers.push_back({scene.module_links[i], coverEnds(pose, scene.controller.tactile_modules[i])});
  return covers;
}

std::vector<std::string> checkArm(const Scene& scene) {
  Warnings warnings;
  checkSizes(scene, warnings);
  checkWeights(scene, warnings);
  checkJointLimits(scene, warnings);
  checkCovers(scene, warnings);
  checkCoverLoads(scene, warnings);
  checkCoversBehindGears(scene, warnings);
  checkEfforts(scene, warnings);
  checkDrives(scene, warnings);
  checkPosture(scene, warnings);
  return warnings;
}

}  // namespace tactus
