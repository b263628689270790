#pragma once

#include "tactus/scene/key_builders.h"
#include "tactus/scene/scene_config.h"

namespace tactus {

keys::Row<SceneConfig> clearanceSection();

}  // namespace tactus
