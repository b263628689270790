#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tactus/daemon/record_sink.h"
#include "tactus/record/tool_error.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// What becomes of a run's cycles outside the loop: a list of sinks.
class Telemetry {
 public:
  /// folder: of run.ulg and summary.json, which exists; empty: no files. Throws as RunLog.
  Telemetry(const Scene& scene, const std::string& folder, LoopLink& link);

  /// Takes what the loop has handed over since the last call, and leaves it with the kernel.
  void drain();

  /// After the loop's end: closes the log and writes the summary. Throws RunError if the summary
  /// cannot be written.
  void finish(const RunEnd& end);

 private:
  const Scene& scene_;
  LoopLink& link_;
  ToolRotationError rotation_error_;
  std::vector<std::unique_ptr<RecordSink>> sinks_;
};

}  // namespace tactus
