#pragma once

#include <string>

#include "tactus/daemon/record_sink.h"
#include "tactus/daemon/run_status.h"

namespace tactus {

/// status.json: at each change of mode, and each half second. Nothing where no StatusFile is
/// wanted.
class StatusSink final : public RecordSink {
 public:
  /// log: nullptr for a run without one.
  StatusSink(const Scene& scene, const LoopLink& link, const LogState* log);

  void add(const LoopRecord& record) override;
  void flush() override;
  void onMode(const ModeReport& report, const std::string& description) override;

 private:
  void show();

  const Scene& scene_;
  const LoopLink& link_;
  const LogState* log_;
  StatusFile file_;
  RunSummary summary_;
  LoopFigures loop_;
  ModeReport report_;
  std::string description_;
};

}  // namespace tactus
