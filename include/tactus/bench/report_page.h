#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tactus/bench/study.h"

namespace tactus {

/// The text of report.json: sections with their plots and tables, for tools/tactus_report.
std::string reportJson(const std::vector<StudyResult>& results);

/// Has `program`, tactus-report, make report.html of what is in `folder`. Returns an empty string,
/// or in one line why there is none.
std::string makeReportPage(const std::filesystem::path& program,
                           const std::filesystem::path& folder);

}  // namespace tactus
