#include "tactus/doctor/disk_check.h"

#include <fmt/format.h>

namespace tactus {
namespace {

constexpr double kHour_s = 3600.0;
constexpr double kShift_s = 8.0 * kHour_s;
constexpr double kMegabyte = 1e6;

}  // namespace

Finding checkDisk(const std::filesystem::path& folder, double free_bytes, double log_bytes_per_s) {
  const double time_s = free_bytes / log_bytes_per_s;
  const std::string what =
      fmt::format("{}: {:.0f} MB free, a log grows by {:.2f} MB/s: {:.1f} h", folder.string(),
                  free_bytes / kMegabyte, log_bytes_per_s / kMegabyte, time_s / kHour_s);
  if (time_s >= kShift_s) return {"disk", Level::kOk, what};
  return {"disk", Level::kWarning, what, "a full disk ends a run",
          fmt::format("make room for a shift of 8 h, {:.0f} MB",
                      kShift_s * log_bytes_per_s / kMegabyte)};
}

}  // namespace tactus
