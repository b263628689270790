#pragma once

#include "tactus/scene/key_builders.h"
#include "tactus/sim/shape_config.h"

/// Rows of the shapes that obstacles and bodies to keep clear of have.
namespace tactus {

keys::Table<SphereConfig> sphereKeys();
keys::Table<PlaneConfig> planeKeys();
keys::Table<LineConfig> obstacleLineKeys();
keys::Table<PostConfig> postKeys();

}  // namespace tactus
