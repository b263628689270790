#include "tactus/math/histogram.h"

#include <algorithm>
#include <cmath>

namespace tactus {

std::int64_t Histogram::highestIn_ns(int bucket) noexcept {
  const int cut = std::max(0, (bucket >> kSubBits) - 1);
  const std::uint64_t leading = static_cast<std::uint64_t>(bucket - (cut << kSubBits));
  return static_cast<std::int64_t>(((leading + 1) << cut) - 1);
}

std::int64_t Histogram::percentile_ns(double percent) const noexcept {
  // 0.999 of 1000 is a little above 999 in doubles.
  constexpr double kRounding = 1.0 - 1e-15;
  const double rank =
      std::ceil(std::clamp(percent, 0.0, 100.0) / 100.0 * kRounding * static_cast<double>(count_));
  const std::uint64_t wanted = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(rank));
  std::uint64_t seen = 0;
  for (int i = 0; i < kBuckets; ++i) {
    seen += counts_[i];
    if (seen >= wanted) return std::min(highestIn_ns(i), max_ns_);
  }
  return max_ns_;
}

}  // namespace tactus
