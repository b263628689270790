#include "tactus/daemon/status_sink.h"

namespace tactus {

StatusSink::StatusSink(const Scene& scene, const LoopLink& link, const LogState* log)
    : scene_(scene), link_(link), log_(log), summary_(scene.controller, 0) {}

void StatusSink::add(const LoopRecord& record) {
  if (!file_.isWanted()) return;
  loop_.wake_latency.add(record.cycle.wake_latency_ns);
  loop_.control.add(record.cycle.step_ns);
  if (record.is_in_motion) summary_.addFigures(record.cycle);
}

void StatusSink::flush() {
  if (file_.isDue()) show();
}

void StatusSink::onMode(const ModeReport& report, const std::string& description) {
  report_ = report;
  description_ = description;
  show();
}

void StatusSink::show() {
  loop_.cycles = link_.pulse.cycles.load(std::memory_order_relaxed);
  loop_.missed_cycles = link_.pulse.missed_cycles.load(std::memory_order_relaxed);
  loop_.dropped_records = static_cast<long long>(link_.records.dropped());
  const RunFigures& figures = summary_.soFar();
  file_.write({scene_, report_.mode, report_.fault, description_,
               link_.pulse.way_on.load(std::memory_order_relaxed), loop_,
               figures.cycles > 0 ? &figures : nullptr, log_});
}

}  // namespace tactus
