#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tactus/record/replay.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/scene/input_error.h"
#include "tactus/scene/json.h"

namespace tactus {

/// The logs of one run, and what to do with them.
struct ReplayRequest {
  std::vector<std::string> logs;      ///< the oldest first; at least one
  std::vector<std::string> settings;  ///< KEY=VALUE, laid over what is logged
  std::string output;  ///< CSV of recorded and replayed commands; empty: none, "-": standard output
};

struct ReplayResult {
  ReplayComparison comparison;
  std::vector<UnknownStretch> unknown;  ///< that were not compared
  std::vector<LogExtent> extents;       ///< of each log

  bool isCutOff() const;  ///< any of the logs
};

/// No cycle can be replayed, as parts of the run before the logs are missing, and the logs do not
/// tell what state the controller was in then.
class MissingPartsError : public LocatedError {
 public:
  using LocatedError::LocatedError;
};

/// Feeds what was recorded to the controller of the log's scene. Throws InputError, also of logs
/// that are damaged or do not belong together, and of one without a cycle that can be replayed.
/// progress: told now and then how far it has come, 0 to 1.
ReplayResult replayLogs(const ReplayRequest& request,
                        const std::function<void(double share)>& progress);

/// What `tactus replay --json` prints.
Json replayJson(const ReplayRequest& request, const ReplayResult& result);

}  // namespace tactus
