#include "tactus/daemon/telemetry.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tactus/canopen/sdo_abort.h"
#include "tactus/record/run_error.h"
#include "tactus/record/tool_error.h"

namespace tactus {
namespace {

std::string describeRefusal(const SetupFailure& failure) {
  return fmt::format(", object {:04X}:{:02X}: {}", failure.index, failure.subindex,
                     failure.abort_code == 0 ? "no answer" : sdoAbortName(failure.abort_code));
}

std::string describeDrive(const ModeReport& report, const Scene& scene) {
  const DriveConfig& drive = scene.hardware->drives[report.joint];
  std::string text =
      fmt::format("drive {} on {} (joint {})", drive.node_id,
                  scene.hardware->buses[drive.bus].interface, scene.joint_names[report.joint]);
  if (report.drive.emergency_code != 0)
    text += fmt::format(", emergency code 0x{:04X}", report.drive.emergency_code);
  if (report.fault == Fault::kDriveSetupRefused)
    text += describeRefusal(report.drive.setup_failure);
  return text + fmt::format(", {}", driveStateName(report.drive.state));
}

std::string describePlace(const ModeReport& report, const Scene& scene) {
  const bool is_prismatic = scene.controller.chain.type(report.joint) == JointType::kPrismatic;
  return fmt::format("joint {} is at {:.6g} {}, expected within {:g} of {:.6g}",
                     scene.joint_names[report.joint], report.q_measured, is_prismatic ? "m" : "rad",
                     scene.hardware->start_tolerance, report.q_expected);
}

std::string describeCulprit(const ModeReport& report, const Scene& scene) {
  if (report.joint >= 0 && report.fault == Fault::kNotAtStart)
    return ", " + describePlace(report, scene);
  if (report.joint >= 0) return ", " + describeDrive(report, scene);
  if (report.bus >= 0) return ", " + scene.hardware->buses[report.bus].interface;
  return "";
}

}  // namespace

std::string describeMode(const ModeReport& report, const Scene& scene) {
  std::string text = modeName(report.mode);
  if (report.fault == Fault::kNone) return text;
  const FaultRow& row = faultRow(report.fault);
  return text + fmt::format(": {}{}: {}; reaction: {}", row.name, describeCulprit(report, scene),
                            row.detection, reactionName(row.reaction));
}

Telemetry::Telemetry(const Scene& scene, const std::string& folder)
    : scene_(scene), folder_(folder), summary_(scene.controller, 0) {
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

void Telemetry::finish(Fault fault, LoopFigures loop) {
  if (!log_) return;
  log_->close();
  loop.wake_latency = loop_.wake_latency;
  loop.read = loop_.read;
  loop.control = loop_.control;
  loop.write = loop_.write;
  RunFigures figures = summary_.figures();
  figures.fault = fault;
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
