#include "tactus/daemon/run_status.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tactus/record/fault_text.h"
#include "tactus/record/message.h"
#include "tactus/record/output_file.h"
#include "tactus/record/time_figures.h"
#include "tactus/rt/periodic_timer.h"

namespace tactus {
namespace {

constexpr double kStatusPeriod_s = 0.5;
constexpr const char* kServiceFolder = "/run/tactus";  ///< of the unit's RuntimeDirectory=

Json motionJson(const RunFigures& figures) {
  return {{"cycles", figures.cycles},
          {"force_N", figures.final_force_N},
          {"peak_force_N", figures.peak_force_N},
          {"stiffness_N_per_m", figures.stiffness_final_N_per_m},
          {"tcp_error_m", figures.tcp_error_final_m},
          {"tcp_error_max_m", figures.tcp_error_max_m}};
}

/// Of what holds the arm now: the cause of the first fault may have gone, and another may be there.
const char* remedyOf(const RunStatus& status) {
  const bool is_waited_for = status.way_on.waits_for == WaitsFor::kFaultGone;
  return faultRow(is_waited_for ? status.way_on.fault : status.fault).remedy;
}

}  // namespace

std::string runtimePath(const char* name) {
  const char* folder = std::getenv("RUNTIME_DIRECTORY");
  return fmt::format("{}/{}", folder && *folder ? folder : kServiceFolder, name);
}

double monotonicTime_s() noexcept { return 1e-9 * static_cast<double>(now_ns()); }

double statusAge_s(const Json& status) {
  const auto found = status.is_object() ? status.find("monotonic_s") : status.end();
  if (found == status.end() || !found->is_number()) return kNoLimit;
  const double age_s = monotonicTime_s() - found->get<double>();
  return age_s >= 0.0 ? age_s : kNoLimit;
}

std::string ageProblem(double age_s) {
  if (age_s <= kMaxStatusAge_s) return "";
  if (age_s == kNoLimit) return "is of before this computer started";
  return fmt::format("no word from the daemon for {:.0f} s", age_s);
}

Json statusJson(const RunStatus& status, double monotonic_s) {
  Json json = {{"scene", status.scene.name},
               {"variant", status.scene.variant},
               {"pid", ::getpid()},
               {"monotonic_s", monotonic_s},
               {"mode", modeName(status.mode)},
               {"fault", faultName(status.fault)},
               {"description", status.description},
               {"waits_for", wayOnText(status.way_on, status.fault)},
               {"remedy", remedyOf(status)},
               {"cycles", status.loop.cycles},
               {"missed_cycles", status.loop.missed_cycles},
               {"dropped_records", status.loop.dropped_records},
               {"wake_latency_ns", timesJson(timeFigures(status.loop.wake_latency))},
               {"control_ns", timesJson(timeFigures(status.loop.control))}};
  if (status.figures) json["motion"] = motionJson(*status.figures);
  if (status.scene.controller.module_loss)
    json["modules_lost"] =
        lostModules(status.scene, status.figures ? status.figures->modules_lost : std::uint64_t{0});
  if (!status.log) return json;
  json["log"] = logJson(*status.log, "writing");
  json["log"]["folder"] = status.log->folder;
  return json;
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
    file.append(jsonText(statusJson(status, written_s_)));
    file.close();
    std::filesystem::rename(next, path_);
  } catch (const std::exception& error) {
    if (has_complained_) return;
    has_complained_ = true;
    say("no status: {}", error.what());
  }
}

}  // namespace tactus
