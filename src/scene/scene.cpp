#include "tactus/scene/scene.h"

namespace tactus {

bool startsMeasured(const Scene& scene) {
  const auto& commands = scene.controller.task.commands;
  return commands && commands->start_measured;
}

bool hasEnableLine(const Scene& scene) {
  return scene.hardware && scene.hardware->gpio && scene.hardware->gpio->enable;
}

}  // namespace tactus
