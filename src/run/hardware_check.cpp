#include "tactus/run/hardware_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace tactus {
namespace {

using Warnings = std::vector<std::string>;

/// The widest limits that somebody may have meant: degrees, mm and ms are beyond.
constexpr double kWidestStart = 0.2;            ///< m or rad
constexpr double kWidestError_m = 0.2;          ///< of a drive
constexpr double kWidestError_rad = 0.5;        ///< of a drive
constexpr double kLongestSilence_s = 1.0;       ///< of a drive, or of the daemon
constexpr double kOldestSample_s = 0.1;         ///< where that is more than some
constexpr double kOldestSample_periods = 10.0;  ///< of these

/// At the start a module shows the whole weight of its cover, where the link lies.
void checkTares(const Scene& scene, Warnings& warnings) {
  const ControllerConfig& config = scene.controller;
  for (std::size_t i = 0; i < scene.hardware->tactile_modules.size(); ++i) {
    const std::optional<CoverConfig>& cover = config.tactile_modules[i].cover;
    if (!cover) continue;
    const double weight_N = cover->mass_kg * config.gravity_Base.norm();
    const double max_offset_N = scene.hardware->tactile_modules[i].tare_max_offset_N;
    if (max_offset_N > weight_N) continue;
    warnings.push_back(fmt::format(
        "tactusd may refuse to start with tare_refused: the cover of {} weighs {:.3g} N, and its "
        "tare.max_offset_N is {:g} N; it has to be above that",
        scene.module_links[i], weight_N, max_offset_N));
  }
}

void checkEnable(const Scene& scene, Warnings& warnings) {
  if (hasEnableLine(scene)) return;
  warnings.emplace_back(
      startsMeasured(scene)
          ? "tactusd refuses task.commands.start_measured: without a line gpio.enable in the "
            "robot's file a restart would move the arm from anywhere"
          : "no gpio.enable: tactusd moves the arm as soon as it is started");
}

void checkStops(const Scene& scene, Warnings& warnings) {
  if (scene.controller.limits.max_acceleration.maxCoeff() < kNoLimit) return;
  warnings.emplace_back(
      "no limits.acceleration: tactusd stops the arm by a step of its speed, and so do the drives "
      "as far as they can");
}

void noteWideDrives(const Scene& scene, Warnings& wide) {
  for (const DriveConfig& drive : scene.hardware->drives) {
    const bool is_prismatic = scene.controller.chain.type(drive.joint) == JointType::kPrismatic;
    if (drive.max_following_error <= (is_prismatic ? kWidestError_m : kWidestError_rad)) continue;
    wide.push_back(fmt::format("max_following_error_{} of {} is {:g}", is_prismatic ? "m" : "rad",
                               scene.joint_names[drive.joint], drive.max_following_error));
  }
}

void noteOldSamples(const Scene& scene, Warnings& wide) {
  for (std::size_t i = 0; i < scene.hardware->tactile_modules.size(); ++i) {
    const double max_age_s = scene.controller.tactile_modules[i].max_sample_age_s;
    const double period_s = scene.hardware->tactile_modules[i].channels.sample_period_s;
    if (max_age_s <= std::max(kOldestSample_s, kOldestSample_periods * period_s)) continue;
    wide.push_back(fmt::format("max_sample_age_s of {} is {:g}", scene.module_links[i], max_age_s));
  }
}

/// Limits by which a fault is noticed.
void checkThresholds(const Scene& scene, Warnings& warnings) {
  const HardwareConfig& hardware = *scene.hardware;
  Warnings wide;
  if (hardware.start_tolerance > kWidestStart)
    wide.push_back(fmt::format("drives.start_tolerance is {:g}", hardware.start_tolerance));
  noteWideDrives(scene, wide);
  if (hardware.canopen.heartbeat_timeout_s > kLongestSilence_s)
    wide.push_back(
        fmt::format("can.heartbeat_timeout_s is {:g}", hardware.canopen.heartbeat_timeout_s));
  noteOldSamples(scene, wide);
  if (wide.empty()) return;
  warnings.push_back(
      fmt::format("limits so wide that tactusd notices faults late, if at all; they are in m, rad "
                  "and s: {}",
                  fmt::join(wide, ", ")));
}

}  // namespace

std::vector<std::string> checkMachine(const Scene& scene) {
  Warnings warnings;
  if (!scene.hardware) return warnings;
  checkEnable(scene, warnings);
  checkStops(scene, warnings);
  checkTares(scene, warnings);
  checkThresholds(scene, warnings);
  return warnings;
}

}  // namespace tactus
