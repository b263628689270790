#include "tactus/daemon/run_status.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "tactus/record/output_file.h"
#include "tactus/record/time_figures.h"
#include "tactus/rt/periodic_timer.h"

namespace tactus {
namespace {

constexpr double kStatusPeriod_s = 0.5;

void writeMotion(const RunFigures& figures, JsonWriter& json) {
  json.key("motion").beginObject();
  json.key("cycles").value(figures.cycles);
  json.key("force_N").value(figures.final_force_N);
  json.key("peak_force_N").value(figures.peak_force_N);
  json.key("stiffness_N_per_m").value(figures.stiffness_final_N_per_m);
  json.key("tcp_error_m").value(figures.tcp_error_final_m);
  json.key("tcp_error_max_m").value(figures.tcp_error_max_m);
  json.endObject();
}

}  // namespace

double monotonicTime_s() noexcept { return 1e-9 * static_cast<double>(now_ns()); }

std::string statusJson(const RunStatus& status, double monotonic_s) {
  JsonWriter json;
  json.beginObject();
  json.key("scene").value(status.scene.name);
  json.key("variant").value(status.scene.variant);
  json.key("pid").value(static_cast<long long>(::getpid()));
  json.key("monotonic_s").value(monotonic_s);
  json.key("mode").value(modeName(status.mode));
  json.key("fault").value(faultName(status.fault));
  json.key("description").value(status.description);
  json.key("cycles").value(status.loop.cycles);
  json.key("missed_cycles").value(status.loop.missed_cycles);
  json.key("dropped_records").value(status.loop.dropped_records);
  writeTimes("wake_latency_ns", timeFigures(status.loop.wake_latency), json);
  writeTimes("control_ns", timeFigures(status.loop.control), json);
  if (status.figures) writeMotion(*status.figures, json);
  if (status.log) writeLogState(*status.log, "writing", json);
  json.endObject();
  return json.text();
}

StatusFile::StatusFile() {
  const char* folder = std::getenv("RUNTIME_DIRECTORY");
  if (folder && *folder) path_ = fmt::format("{}/{}", folder, kStatusName);
}

StatusFile::~StatusFile() {
  if (isWanted()) std::remove(path_.c_str());
}

bool StatusFile::isDue() const noexcept {
  return isWanted() && monotonicTime_s() - written_s_ >= kStatusPeriod_s;
}

void StatusFile::write(const RunStatus& status) {
  if (!isWanted()) return;
  written_s_ = monotonicTime_s();
  try {
    const std::string next = path_ + ".next";
    OutputFile file(next);
    file.append(statusJson(status, written_s_));
    file.close();
    std::filesystem::rename(next, path_);
  } catch (const std::exception& error) {
    if (has_complained_) return;
    has_complained_ = true;
    std::fputs(fmt::format("tactusd: no status: {}\n", error.what()).c_str(), stderr);
  }
}

}  // namespace tactus
