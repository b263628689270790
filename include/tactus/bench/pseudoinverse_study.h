#pragma once

#include <vector>

#include "tactus/bench/table.h"

namespace tactus {

struct PseudoinverseSizes {
  std::vector<int> task_sizes = {3, 6};
  int joints = 9;
  int decades = 12;   ///< ratios of singular values 1, 0.1, ... 10^-decades
  int problems = 64;  ///< random ones for each ratio
  int batches = 15;   ///< timed
};

/// A row for each method, scalar, task size and ratio. Errors are relative: of J# w to its own
/// length, of N v to that of v; of each the largest over all problems, and the median of J# w's.
Table measurePseudoinverses(const PseudoinverseSizes& sizes);

}  // namespace tactus
