#pragma once

#include <string>

namespace tactus {

/// Path of the log that the daemon writes, by its status. Throws RunError: none runs, or it writes
/// none.
std::string runningLog();

}  // namespace tactus
