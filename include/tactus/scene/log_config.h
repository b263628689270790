#pragma once

namespace tactus {

inline constexpr int kMaxKeptLogs = 100;

/// How much of a disk the log of a daemon may take.
struct LogConfig {
  double max_bytes = 0.0;  ///< of a file, before it is full and a new one is begun; 0: no limit
  int keep = 4;            ///< full files that stay
  double min_free_bytes = 1e8;  ///< the log stops when less of the disk is free; 0: never
};

}  // namespace tactus
