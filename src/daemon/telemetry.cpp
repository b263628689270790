#include "tactus/daemon/telemetry.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tactus/record/fault_text.h"
#include "tactus/record/run_error.h"

namespace tactus {

Telemetry::Telemetry(const Scene& scene, const std::string& folder)
    : scene_(scene),
      folder_(folder),
      summary_(scene.controller, 0),
      rotation_error_(scene.controller) {
  if (!folder_.empty()) log_.emplace(scene, folder_);
}

void Telemetry::drain(LoopLink& link) {
  while (link.records.pop(record_)) {
    CycleRecord& cycle = record_.cycle;
    loop_.wake_latency.add(cycle.wake_latency_ns);
    loop_.read.add(cycle.read_ns);
    loop_.control.add(cycle.step_ns);
    loop_.write.add(cycle.write_ns);
    if (!record_.is_in_motion || !(log_ || status_file_.isWanted())) continue;
    fillToolError(scene_.controller, cycle);
    rotation_error_.fill(cycle);
    if (log_) log_->write(cycle);
    log_ ? summary_.add(cycle) : summary_.addFigures(cycle);
  }
  if (log_) log_->flush();
  while (link.reports.pop(report_)) {
    description_ = describeMode(report_, scene_);
    showStatus(link);  // before the service manager hears of it, and people look
    service_.onMode(report_.mode, description_);
    std::fputs(fmt::format("tactusd: {}\n", description_).c_str(), stderr);
  }
  if (status_file_.isDue()) showStatus(link);
}

void Telemetry::showStatus(const LoopLink& link) {
  loop_.cycles = link.pulse.cycles.load(std::memory_order_relaxed);
  loop_.missed_cycles = link.pulse.missed_cycles.load(std::memory_order_relaxed);
  loop_.dropped_records = static_cast<long long>(link.records.dropped());
  const RunFigures& figures = summary_.soFar();
  status_file_.write({scene_, report_.mode, report_.fault, description_, loop_,
                      figures.cycles > 0 ? &figures : nullptr, log_ ? &log_->state() : nullptr});
}

void Telemetry::finish(const FaultReport& end, LoopFigures loop) {
  if (!log_) return;
  log_->close();
  loop.wake_latency = loop_.wake_latency;
  loop.read = loop_.read;
  loop.control = loop_.control;
  loop.write = loop_.write;
  RunFigures figures = summary_.figures();
  figures.end = end;
  const std::string path = folder_ + "/summary.json";
  try {
    const Json loop_json = loopJson(loop);
    const HardwareFigures hardware{log_->state(), loop_json};
    writeSummary(path, scene_, figures, 1.0, &hardware);
  } catch (const std::runtime_error& error) {
    std::remove(path.c_str());     // half of one
    throw RunError(error.what());  // of input, too: the arm has moved
  }
}

}  // namespace tactus
