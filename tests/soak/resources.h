#pragma once

#include <string>

namespace tactus::soak {

/// What this process holds, and its log on the disk.
struct Resources {
  double resident_bytes = 0.0;
  double heap_bytes = 0.0;  ///< handed out by malloc
  int descriptors = 0, threads = 0;
  int log_files = 0;
  double log_bytes = 0.0;
};

/// folder: of the log.
Resources resourcesNow(const std::string& folder);

}  // namespace tactus::soak
