#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tactus/bench/judged_run.h"
#include "tactus/bench/table.h"

namespace tactus {

/// Environments that no law was made for: a start near the base's, a straight path, a post of 1e3
/// to 1e6 N/m that the link meets on it, often a band of 5 to 600 N/m elsewhere, an arm of 2e3 to
/// 1e5 N/m or a rigid one, 0.3 to 5 times the base's speed; null_limit with its estimator, and 20 s
/// to come to rest. base: one waypoint and one tactile module. Draws whose path does not lead the
/// link to the post are left out.
std::vector<RunSetup> drawEnvironments(const RunSetup& base, std::uint64_t seed, int count);

struct DrawnRun {
  JudgedRun run;
  /// A post has come over an end of the cover, where it is met at once and deep, or touches it at
  /// the start: the run says nothing of the law.
  bool is_out = false;
};

DrawnRun runDrawn(const RunSetup& setup);

/// What became of them, with the estimator and without; a row of a table.
void addDrawnRow(const std::string& arm, const std::vector<RunSetup>& setups, Table& table);
Table emptyDrawnTable();

}  // namespace tactus
