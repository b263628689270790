#include "tactus/doctor/disk_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kHour_s = 3600.0;
constexpr double kShift_s = 8.0 * kHour_s;
constexpr double kMegabyte = 1e6;

}  // namespace

Finding checkDisk(const std::filesystem::path& folder, double free_bytes, const LogNeeds& log) {
  const bool is_limited = std::isfinite(log.most_bytes);
  const double usable_bytes = std::max(0.0, free_bytes - log.reserve_bytes);
  const double needed_bytes = is_limited ? log.most_bytes : kShift_s * log.bytes_per_s;
  std::string what = fmt::format(
      "{}: {:.0f} MB free, {:.0f} MB of them for a log that grows by {:.2f} MB/s", folder.string(),
      free_bytes / kMegabyte, usable_bytes / kMegabyte, log.bytes_per_s / kMegabyte);
  what += is_limited
              ? fmt::format(" to at most {:.0f} MB", log.most_bytes / kMegabyte)
              : fmt::format(" without a limit: {:.1f} h", usable_bytes / log.bytes_per_s / kHour_s);
  if (usable_bytes >= needed_bytes) return {"disk", Level::kOk, what};
  const double room_bytes = needed_bytes + log.reserve_bytes;
  return {"disk", Level::kWarning, what, "the log stops before the disk is full, the arm goes on",
          is_limited ? fmt::format("make room for {:.0f} MB, or lower max_bytes or keep of the "
                                   "scene's section log",
                                   std::ceil(room_bytes / kMegabyte))
                     : fmt::format("make room for a shift of 8 h, {:.0f} MB, or set log.max_bytes "
                                   "in the scene",
                                   std::ceil(room_bytes / kMegabyte))};
}

}  // namespace tactus
