#include "tactus/bench/base_scene.h"

#include <fmt/format.h>

#include "tactus/scene/located_error.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

Scene loadBase(const std::string& path, const BaseNeeds& needs,
               const std::vector<Override>& overrides) {
  Scene scene = loadScene(path, overrides, SceneUse::kSimulation);
  const auto require = [&](bool is_there, const char* key, const std::string& expected) {
    if (!is_there)
      failAt(locate(*scene.tree, key), key, "too little for the studies that are asked for",
             "expected " + expected);
  };
  const ControllerConfig& config = scene.controller;
  require(config.force_control.has_value(), "controller.variant", "a law, such as null_limit");
  require(!config.task.trajectory.waypoints.empty(), "task.trajectory", "a line, or waypoints");
  require(config.tactile_modules.size() >= needs.modules, "tactile_modules",
          fmt::format("at least {}", needs.modules));
  require(scene.plant.obstacles.size() >= needs.obstacles, "simulation.obstacles",
          fmt::format("at least {}", needs.obstacles));
  return scene;
}

RunSetup setupOf(const Scene& scene) {
  return {scene.controller, scene.plant, scene.period_s, scene.duration_s};
}

}  // namespace tactus
