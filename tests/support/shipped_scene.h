#pragma once

#include <string>
#include <vector>

#include "tactus/scene/scene_loader.h"

namespace tactus::test {

/// A scene of config/scenes by its name.
inline Scene shippedScene(const std::string& name, const std::vector<Override>& overrides = {}) {
  return loadScene(std::string(TACTUS_SOURCE_DIR) + "/config/scenes/" + name + ".yaml", overrides);
}

}  // namespace tactus::test
