#pragma once

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "tactus/record/ulog_reader.h"
#include "tactus/record/ulog_writer.h"

namespace tactus {

/// Which part of which run a log is.
struct LogPart {
  std::string run;  ///< empty: of a run with one log, by tactus simulate or an older version
  int part = 0;     ///< counts from 0
};

/// `path` is what errors call the log. Throws InputError.
LogPart logPart(const LogDescription& description, const std::string& path);

/// Whether a file that took the place of another one goes on with its run; no run: it is the first.
/// Sets the run. Throws as logPart().
bool isOfRun(const LogDescription& description, const std::string& path,
             std::optional<std::string>& run);

/// The files that are there of a run that writes `newest`, a run.ulg: the oldest first.
std::vector<std::string> logsOfRun(const std::string& newest);

/// All opened at once, as the daemon that writes them renames them. Throws InputError as openLog().
std::vector<std::ifstream> openLogs(const std::vector<std::string>& paths);

/// Throws InputError unless a part is a later one of the same run as the one before it.
void checkOrder(const std::string& path, const LogPart& part, const std::string& path_before,
                const LogPart& before);

/// Reads logs to their ends, so that damaged ones, and such as are not the parts of one run in
/// their order, are refused before anything else happens. Throws InputError, also if no log has a
/// cycle.
std::vector<LogExtent> checkParts(const std::vector<std::string>& paths);

}  // namespace tactus
