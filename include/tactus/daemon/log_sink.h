#pragma once

#include <string>

#include "tactus/daemon/record_sink.h"
#include "tactus/record/run_log.h"

namespace tactus {

/// The log, from the first cycle of motion on.
class LogSink final : public RecordSink {
 public:
  /// Throws as RunLog.
  LogSink(const Scene& scene, const std::string& folder) : log_(scene, folder) {}

  const LogState& state() const noexcept { return log_.state(); }

  void add(const LoopRecord& record) override;
  void flush() override { log_.flush(); }
  void finish(const RunEnd&) override { log_.close(); }

 private:
  RunLog log_;
};

}  // namespace tactus
