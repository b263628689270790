#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "tactus/control/robot.h"
#include "tactus/scene/json.h"

/// Forces of a run with fewer points than cycles, in which no peak is lost.
namespace tactus {

/// A stretch of time with the smallest and the largest force of each module, F_sen. One without a
/// finite force has infinities.
struct ForceBin {
  double from_s = 0.0;  ///< first and last cycle
  double to_s = 0.0;
  std::array<double, kMaxTactileModules> least_N, most_N;

  explicit ForceBin(double t_s = 0.0) noexcept : from_s(t_s), to_s(t_s) {
    least_N.fill(std::numeric_limits<double>::infinity());
    most_N.fill(-std::numeric_limits<double>::infinity());
  }
};

/// Extends a bin by a later one.
void extend(ForceBin& bin, const ForceBin& later) noexcept;

/// Collects cycles into bins of equal width.
class ForceBins {
 public:
  explicit ForceBins(double width_s) noexcept : width_s_(width_s) {}

  /// One force a module.
  void add(double t_s, std::span<const double> force_N);

  /// Those that are complete, in the order of time. They may be removed.
  std::vector<ForceBin>& complete() noexcept { return complete_; }

 private:
  double width_s_;
  std::vector<ForceBin> complete_;
  ForceBin present_;
  bool has_present_ = false;
};

/// At most so many: neighbours become one.
std::vector<ForceBin> fewerBins(std::span<const ForceBin> bins, std::size_t most);

/// {"t": [from, ...], "low": [[N, ...] a module], "high": [...]}, with times from `zero_s` on and
/// null for a bin without a force. modules: the first, and how many.
Json forceJson(std::span<const ForceBin> bins, int first_module, int modules, double zero_s = 0.0);

}  // namespace tactus
