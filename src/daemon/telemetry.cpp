#include "tactus/daemon/telemetry.h"

#include <utility>

#include "tactus/daemon/journal_sink.h"
#include "tactus/daemon/log_sink.h"
#include "tactus/daemon/loss_sink.h"
#include "tactus/daemon/status_sink.h"
#include "tactus/daemon/summary_sink.h"
#include "tactus/record/fault_text.h"

namespace tactus {

/// In an order that counts: the summary tells of the closed log, and the status is there before the
/// service manager hears of it, and people look.
Telemetry::Telemetry(const Scene& scene, const std::string& folder, LoopLink& link)
    : scene_(scene), link_(link), rotation_error_(scene.controller) {
  const LogState* log_state = nullptr;
  if (!folder.empty()) {
    auto log = std::make_unique<LogSink>(scene, folder);
    log_state = &log->state();
    sinks_.push_back(std::move(log));
    sinks_.push_back(std::make_unique<SummarySink>(scene, folder, *log_state));
  }
  sinks_.push_back(std::make_unique<StatusSink>(scene, link, log_state));
  sinks_.push_back(std::make_unique<JournalSink>());
  if (scene.controller.module_loss) sinks_.push_back(std::make_unique<LossSink>(scene));
}

void Telemetry::drain() {
  while (LoopRecord* const record = link_.records.front()) {
    if (record->is_in_motion) fillToolError(scene_.controller, record->cycle);
    if (record->is_in_motion) rotation_error_.fill(record->cycle);
    for (const auto& sink : sinks_) sink->add(*record);
    link_.records.release();
  }
  for (const auto& sink : sinks_) sink->flush();
  ModeReport report;
  while (link_.reports.pop(report)) {
    const std::string description = describeMode(report, scene_);
    for (const auto& sink : sinks_) sink->onMode(report, description);
  }
}

void Telemetry::finish(const RunEnd& end) {
  for (const auto& sink : sinks_) sink->finish(end);
}

}  // namespace tactus
