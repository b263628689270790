#pragma once

#include <string>

#include "tactus/record/ulog_reader.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// The scene that a log holds. Throws InputError, also where the log has fewer tactile modules.
Scene loggedScene(const UlogReader& reader, const std::string& path);

}  // namespace tactus
