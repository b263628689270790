#include "tactus/record/run_summary.h"

#include <algorithm>
#include <cmath>

#include "tactus/record/output_file.h"
#include "tactus/record/tool_error.h"
#include "tactus/scene/json.h"

namespace tactus {
namespace {

/// Makes "at the limit" insensitive to rounding; the command limiter reaches limits exactly.
constexpr double kLimitTolerance = 1e-4;  // m or rad

double norm(const double (&vector)[3]) noexcept {
  return std::sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

void writeContact(const ContactSummary& contact, JsonWriter& json) {
  json.beginObject();
  json.key("start_s").value(contact.start_s);
  json.key("end_s").value(contact.end_s);
  json.key("peak_force_N").value(contact.peak_force_N);
  json.key("settling_s").value(contact.settling_s);
  json.endObject();
}

void writeFigures(const RunFigures& figures, JsonWriter& json) {
  json.key("cycles").value(figures.cycles);
  json.key("peak_force_N").value(figures.peak_force_N);
  json.key("final_force_N").value(figures.final_force_N);
  json.key("tcp_error_max_m").value(figures.tcp_error_max_m);
  json.key("tcp_error_rms_m").value(figures.tcp_error_rms_m);
  json.key("tcp_error_final_m").value(figures.tcp_error_final_m);
  if (const auto& rotation = figures.tcp_rotation_error) {
    json.key("tcp_rotation_error_max_rad").value(rotation->max_rad);
    json.key("tcp_rotation_error_rms_rad").value(rotation->rms_rad);
    json.key("tcp_rotation_error_final_rad").value(rotation->final_rad);
  }
  json.key("peak_joint_speed_squared").value(figures.peak_joint_speed_squared);
  json.key("joints_at_limit_cycles").value(figures.joints_at_limit_cycles);
  json.key("stiffness_final_N_per_m").value(figures.stiffness_final_N_per_m);
  json.key("stiffness_at_peak_N_per_m").value(figures.stiffness_at_peak_N_per_m);
  json.key("contacts").beginArray();
  for (const ContactSummary& contact : figures.contacts) writeContact(contact, json);
  json.endArray();
  writeTimes("step_time_ns", figures.step_time_ns, json);
}

}  // namespace

RunSummary::RunSummary(const ControllerConfig& config, std::size_t expected_cycles)
    : limits_(config.limits), contacts_(config.force_control, expected_cycles) {
  if (hasRotation(config.task)) figures_.tcp_rotation_error.emplace();
}

void RunSummary::add(const CycleRecord& record) {
  addFigures(record);
  contacts_.add(record);
}

void RunSummary::addFigures(const CycleRecord& record) noexcept {
  ++figures_.cycles;
  if (record.force_sensor_N > figures_.peak_force_N) {
    figures_.peak_force_N = record.force_sensor_N;
    figures_.stiffness_at_peak_N_per_m = record.stiffness_N_per_m;
  }
  figures_.final_force_N = record.force_sensor_N;
  figures_.stiffness_final_N_per_m = record.stiffness_N_per_m;
  figures_.fault = static_cast<Fault>(record.fault);
  addToolError(record);
  addJoints(record);
  step_times_.add(record.step_ns);
}

void RunSummary::addToolError(const CycleRecord& record) noexcept {
  const double error_m = norm(record.tool_error_m);
  figures_.tcp_error_max_m = std::max(figures_.tcp_error_max_m, error_m);
  figures_.tcp_error_final_m = error_m;
  squared_error_sum_m2_ += error_m * error_m;
  if (!figures_.tcp_rotation_error) return;
  const double error_rad = record.tool_rotation_error_rad;
  RotationError& rotation = *figures_.tcp_rotation_error;
  rotation.max_rad = std::max(rotation.max_rad, error_rad);
  rotation.final_rad = error_rad;
  squared_rotation_sum_rad2_ += error_rad * error_rad;
}

void RunSummary::addJoints(const CycleRecord& record) noexcept {
  double speed_squared = 0.0;
  bool is_at_limit = false;
  for (int i = 0; i < limits_.lower.size(); ++i) {
    speed_squared += record.dq[i] * record.dq[i];
    is_at_limit |= record.q[i] <= limits_.lower[i] + kLimitTolerance ||
                   record.q[i] >= limits_.upper[i] - kLimitTolerance;
  }
  figures_.peak_joint_speed_squared = std::max(figures_.peak_joint_speed_squared, speed_squared);
  figures_.joints_at_limit_cycles += is_at_limit ? 1 : 0;
}

RunFigures RunSummary::figures() const {
  RunFigures figures = figures_;
  if (figures.cycles > 0) {
    const auto cycles = static_cast<double>(figures.cycles);
    figures.tcp_error_rms_m = std::sqrt(squared_error_sum_m2_ / cycles);
    if (figures.tcp_rotation_error)
      figures.tcp_rotation_error->rms_rad = std::sqrt(squared_rotation_sum_rad2_ / cycles);
  }
  figures.contacts = contacts_.contacts();
  figures.step_time_ns = timeFigures(step_times_);
  return figures;
}

std::string summaryJson(const Scene& scene, const RunFigures& figures, double real_time_factor,
                        const HardwareFigures* hardware) {
  JsonWriter json;
  json.beginObject();
  json.key("scene").value(scene.name);
  json.key("variant").value(scene.variant);
  json.key("stages").beginArray();
  for (const std::string& stage : stageNames(scene.controller)) json.value(stage);
  if (hardware) {
    for (const std::string& stage : hardwareStageNames(*scene.hardware)) json.value(stage);
  }
  json.endArray();
  writeFigures(figures, json);
  if (hardware) {
    hardware->write_loop(json);
    writeLogState(hardware->log, "complete", json);
  }
  json.key("real_time_factor").value(real_time_factor);
  json.key("outcome").value(figures.fault == Fault::kNone ? "completed" : faultName(figures.fault));
  json.endObject();
  return json.text();
}

void writeSummary(const std::string& path, const Scene& scene, const RunFigures& figures,
                  double real_time_factor, const HardwareFigures* hardware) {
  OutputFile file(path);
  file.append(summaryJson(scene, figures, real_time_factor, hardware));
  file.close();
}

}  // namespace tactus
