#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tactus/scene/input_error.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// What a scene is loaded for. Only a run on hardware has to fit its buses and drives (bus load,
/// heartbeats, tracking gains): virtual time has no bus, so that any cycle can be tried there.
enum class SceneUse { kHardware, kSimulation };

/// Loads a scene with everything it names and lays the overrides over it. Every value is checked;
/// throws InputError at the first that is wrong.
Scene loadScene(const std::string& path, const std::vector<Override>& overrides,
                SceneUse use = SceneUse::kHardware);

/// The same from files as Scene::sources holds them; the first one is the scene.
Scene loadScene(const std::vector<SourceFile>& files, const std::vector<Override>& overrides,
                SceneUse use = SceneUse::kHardware);

/// Splits `controller.damping=0.7`. Throws InputError.
Override parseOverride(std::string_view text);

}  // namespace tactus
