#pragma once

#include <string>
#include <vector>

#include "tactus/bench/extreme_run.h"

namespace tactus {

struct ExtremeRow {
  ExtremeCase extreme;
  ExtremeLaw law;
  ExtremeRun run;
};

/// Every case with every law, on all processors; the order is that of cases, then laws, and no
/// result depends on the number of processors.
std::vector<ExtremeRow> runExtremes(const std::string& base, const std::vector<ExtremeCase>& cases,
                                    const std::vector<ExtremeLaw>& laws, double duration_share);

Table extremeTable(const std::vector<ExtremeRow>& rows);
/// Of each group and law: how many rows ended how.
Table extremeSummary(const std::vector<ExtremeRow>& rows);
/// Of the long runs: what became of every number of the state.
Table extremeStates(const std::vector<ExtremeRow>& rows);

}  // namespace tactus
