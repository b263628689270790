#include "tactus/record/logged_scene.h"

#include <memory>

#include "tactus/scene/located_error.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {

Scene loggedScene(const UlogReader& reader, const std::string& path) {
  const LogDescription& description = reader.description();
  Scene scene = loadScene(description.sources, description.overrides, SceneUse::kSimulation);
  if (static_cast<std::size_t>(description.shape.modules) < scene.module_links.size())
    failAt(beginOf(path), "force_sensor_N", "has fewer tactile modules than its scene",
           "expected one of each");
  return scene;
}

}  // namespace tactus
