#pragma once

#include <string>

#include "tactus/daemon/record_sink.h"
#include "tactus/record/run_log.h"
#include "tactus/record/run_summary.h"

namespace tactus {

/// summary.json: figures of the motion, and the times of all cycles.
class SummarySink final : public RecordSink {
 public:
  /// log: of the same run, closed before finish().
  SummarySink(const Scene& scene, const std::string& folder, const LogState& log);

  void add(const LoopRecord& record) override;
  /// Throws RunError, and leaves no file, if it cannot be written.
  void finish(const RunEnd& end) override;

 private:
  const Scene& scene_;
  std::string path_;
  const LogState& log_;
  RunSummary summary_;
  LoopFigures times_;
};

}  // namespace tactus
