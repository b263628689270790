#pragma once

#include <string>

#include "tactus/scene/json.h"

namespace tactus {

/// status.json of the daemon that runs; null: there is none that can be read.
Json readRunStatus();

/// Why there is a status that this process may not read; empty: it may, or there is none.
std::string statusRefusal();

/// Path of the log that a status names; empty: none.
std::string logOf(const Json& status);

/// Path of the log that the daemon writes, by its status. Throws RunError: none runs, or has
/// written for a while, or it writes no log.
std::string runningLog();

}  // namespace tactus
