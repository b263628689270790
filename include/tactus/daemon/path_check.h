#pragma once

#include <string>
#include <vector>

#include "tactus/daemon/scene.h"

namespace tactus {

/// What is doubtful about the motion of a scene that meets nothing: a start near a singularity, a
/// path that the joints cannot follow. For people, to be printed as warnings.
std::vector<std::string> checkPath(const Scene& scene);

}  // namespace tactus
