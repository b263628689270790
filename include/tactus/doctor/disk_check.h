#pragma once

#include <filesystem>
#include <limits>

#include "tactus/doctor/finding.h"

namespace tactus {

/// What a daemon's log takes of its disk.
struct LogNeeds {
  double bytes_per_s = 0.0;
  double most_bytes = std::numeric_limits<double>::infinity();  ///< of all files that are kept
  double reserve_bytes = 0.0;                                   ///< with less left the log stops
};

/// Whether all of a log fits into the free space of a folder; of one without a limit a shift of
/// 8 h.
Finding checkDisk(const std::filesystem::path& folder, double free_bytes, const LogNeeds& log);

}  // namespace tactus
