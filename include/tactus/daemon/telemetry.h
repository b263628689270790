#pragma once

#include <optional>
#include <string>

#include "tactus/daemon/loop_figures.h"
#include "tactus/daemon/loop_link.h"
#include "tactus/daemon/run_status.h"
#include "tactus/daemon/service_notify.h"
#include "tactus/record/run_log.h"
#include "tactus/record/run_summary.h"
#include "tactus/record/tool_error.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// What becomes of a run's cycles outside the loop: the log, the figures, the status file, and for
/// each change of mode a line and a word to the service manager.
class Telemetry {
 public:
  /// folder: of run.ulg and summary.json, which exists; empty: no files. Throws as RunLog.
  Telemetry(const Scene& scene, const std::string& folder);

  /// Takes what the loop has handed over since the last call, and leaves it with the kernel.
  void drain(LoopLink& link);

  /// After the loop's end: closes the log and writes the summary. `end` is the fault that ended
  /// the run, if any; `loop` has all but the times. Throws RunError if the summary cannot be
  /// written.
  void finish(const FaultReport& end, LoopFigures loop);

 private:
  void showStatus(const LoopLink& link);

  const Scene& scene_;
  std::string folder_;
  ServiceNotify service_;
  StatusFile status_file_;
  ModeReport report_;
  std::string description_;
  std::optional<RunLog> log_;
  RunSummary summary_;
  ToolRotationError rotation_error_;
  LoopFigures loop_;
  LoopRecord record_;
};

}  // namespace tactus
