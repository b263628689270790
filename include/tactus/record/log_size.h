#pragma once

#include "tactus/scene/scene.h"

namespace tactus {

/// Throws InputError if LogConfig::max_bytes is too small for the scene itself and some cycles.
void checkLogSize(const Scene& scene);

}  // namespace tactus
