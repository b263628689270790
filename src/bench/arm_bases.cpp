#include "tactus/bench/arm_bases.h"

#include "tactus/scene/scene_loader.h"

namespace tactus {

ArmBases armBases(const std::string& scene_path) {
  ArmBases bases;
  for (const char* arm : kArms) {
    const Scene scene = loadScene(scene_path, {{"simulation.arm", arm}}, SceneUse::kSimulation);
    bases.push_back({scene.controller, scene.plant, scene.period_s, scene.duration_s});
    const bool has_more = scene.arm && (bases.size() < 2 || scene.arm->has_gears);
    if (!has_more) break;
  }
  return bases;
}

}  // namespace tactus
