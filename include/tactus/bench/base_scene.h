#pragma once

#include <string>
#include <vector>

#include "tactus/bench/judged_run.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {

/// What a study asks of the scene that it varies, beside force control and a waypoint.
struct BaseNeeds {
  std::size_t modules = 1, obstacles = 0;
};

/// Throws InputError where the scene is broken, or lacks what is needed.
Scene loadBase(const std::string& path, const BaseNeeds& needs,
               const std::vector<Override>& overrides = {});
RunSetup setupOf(const Scene& scene);

}  // namespace tactus
