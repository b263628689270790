#pragma once

#include <string>
#include <vector>

#include "support/shipped_scene.h"

/// Every law that answers one contact, under an enable line.
namespace tactus::test {

/// With "/a" at the acceleration level.
inline constexpr const char* kLaws[] = {"null_space", "joint_space", "task_space",  "null_task",
                                        "null_joint", "null_limit",  "null_task/a", "null_limit/a"};

/// A shipped scene by one of them.
inline Scene sceneByLaw(const std::string& file, const std::string& law, bool has_posture = false) {
  const std::size_t slash = law.find('/');
  std::vector<Override> overrides = {{"controller.variant", law.substr(0, slash)}};
  if (slash != std::string::npos) overrides.push_back({"controller.level", "acceleration"});
  if (has_posture) overrides.push_back({"redundancy.posture", "{}"});
  Scene scene = shippedScene(file, overrides);
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  return scene;
}

}  // namespace tactus::test
