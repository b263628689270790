#pragma once

#include <vector>

#include "tactus/scene/key_table.h"

namespace tactus {

/// Completes the rows of a table with the default values that a new config has. `config` is one,
/// whose optional parts are made on the way.
void addDefaults(std::vector<KeySpec>& keys, void* config);

}  // namespace tactus
