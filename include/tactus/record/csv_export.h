#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace tactus {

/// Writes every cycle of a log as a line of CSV with the fields that the log has, and at its end
/// the names of fault and mode; `csv_path` "-" is standard output. Throws InputError if the log is
/// damaged (see checkLog()), RunError if writing fails.
/// progress: told the cycles so far, now and then; may be empty.
void exportCsv(const std::string& log_path, const std::string& csv_path,
               const std::function<void(std::uint64_t cycles)>& progress = {});

}  // namespace tactus
