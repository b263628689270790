#include "tactus/run/hardware_check.h"

#include <fmt/format.h>

namespace tactus {
namespace {

using Warnings = std::vector<std::string>;

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

/// Where a start has to be asked for tactusd refuses it without the line: see checkArm().
void checkEnable(const Scene& scene, Warnings& warnings) {
  if (hasEnableLine(scene) || startsMeasured(scene)) return;
  warnings.emplace_back("no gpio.enable: tactusd moves the arm as soon as it is started");
}

void checkStops(const Scene& scene, Warnings& warnings) {
  if (scene.controller.limits.max_acceleration.maxCoeff() < kNoLimit) return;
  warnings.emplace_back(
      "no limits.acceleration: tactusd stops the arm by a step of its speed, and so do the drives "
      "as far as they can");
}

}  // namespace

std::vector<std::string> checkMachine(const Scene& scene) {
  Warnings warnings;
  if (!scene.hardware) return warnings;
  checkEnable(scene, warnings);
  checkStops(scene, warnings);
  checkTares(scene, warnings);
  return warnings;
}

}  // namespace tactus
