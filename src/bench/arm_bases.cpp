#include "tactus/bench/arm_bases.h"

#include "tactus/bench/base_scene.h"

namespace tactus {

ArmBases armBases(const std::string& scene_path) {
  ArmBases bases;
  for (const char* arm : kArms) {
    const Scene scene = loadBase(scene_path, {.obstacles = 2}, {{"simulation.arm", arm}});
    bases.push_back(setupOf(scene));
    const bool has_more = scene.arm && (bases.size() < 2 || scene.arm->has_gears);
    if (!has_more) break;
  }
  return bases;
}

}  // namespace tactus
