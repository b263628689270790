#include "tactus/scene/command_scene.h"

#include <algorithm>
#include <utility>

#include "tactus/scene/located_error.h"

namespace tactus {

std::vector<Override> parseOverrides(const std::vector<std::string>& settings) {
  std::vector<Override> overrides;
  for (const std::string& setting : settings) {
    Override parsed = parseOverride(setting);
    if (std::ranges::count(overrides, parsed.key, &Override::key) > 0)
      failAt(beginOf("--set " + parsed.key), parsed.key, "is given twice",
             "expected each key once");
    overrides.push_back(std::move(parsed));
  }
  return overrides;
}

Scene loadHardwareScene(const std::string& path, const std::vector<std::string>& settings,
                        const char* purpose) {
  Scene scene = loadScene(path, parseOverrides(settings));
  if (!scene.hardware)
    failAt({std::make_shared<std::string>(path), 1, 1}, "robot", "has no can section",
           std::string("expected buses and drives ") + purpose);
  return scene;
}

}  // namespace tactus
