#pragma once

#include <string>

#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// What `tactus check` says of what a scene keeps clear of: each link with all others, and what is
/// nearest at the start. Nothing without a clearance.
std::string clearanceText(const Scene& scene);
/// Adds the member clearance.
void addClearance(const Scene& scene, Json& json);

/// Comments that say which capsules of links that are no neighbours touch at the start: those that
/// robot.yaml has, or else the proposed ones.
std::string touchingCapsules(const Scene& scene, const std::string& proposed);

}  // namespace tactus
