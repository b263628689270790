#include "tactus/record/run_summary.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tactus/record/contact_json.h"
#include "tactus/record/fault_text.h"
#include "tactus/record/output_file.h"
#include "tactus/record/tool_error.h"
#include "tactus/record/unsensed_text.h"

namespace tactus {
namespace {

/// Makes "at the limit" insensitive to rounding; the command limiter reaches limits exactly.
constexpr double kLimitTolerance = 1e-4;  // m or rad

/// So that memory stays bounded however long the run is: some 5 MB.
constexpr std::size_t kMostContacts = 10000;
constexpr std::size_t kMostLosses = 10000;

double norm(const double (&vector)[3]) noexcept {
  return std::sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

Json lossesJson(const RunFigures& figures, const Scene& scene) {
  Json losses = Json::array();
  for (const ModuleLoss& loss : figures.module_losses)
    losses.push_back({{"tactile_module", scene.module_links[loss.module]},
                      {"start_s", loss.start_s},
                      {"end_s", loss.end_s}});
  return losses;
}

void addTo(Json& json, const RunFigures& figures, const Scene& scene) {
  json["cycles"] = figures.cycles;
  json["peak_force_N"] = figures.peak_force_N;
  json["final_force_N"] = figures.final_force_N;
  json["tcp_error_max_m"] = figures.tcp_error_max_m;
  json["tcp_error_rms_m"] = figures.tcp_error_rms_m;
  json["tcp_error_final_m"] = figures.tcp_error_final_m;
  if (const auto& rotation = figures.tcp_rotation_error) {
    json["tcp_rotation_error_max_rad"] = rotation->max_rad;
    json["tcp_rotation_error_rms_rad"] = rotation->rms_rad;
    json["tcp_rotation_error_final_rad"] = rotation->final_rad;
  }
  json["peak_joint_speed_squared"] = figures.peak_joint_speed_squared;
  json["joints_at_limit_cycles"] = figures.joints_at_limit_cycles;
  json["stiffness_final_N_per_m"] = figures.stiffness_final_N_per_m;
  json["stiffness_at_peak_N_per_m"] = figures.stiffness_at_peak_N_per_m;
  Json& contacts = json["contacts"] = Json::array();
  for (const ContactFigures& contact : figures.contacts)
    contacts.push_back(contactJson(contact, scene.module_links));
  if (figures.further_contacts > 0) json["further_contacts"] = figures.further_contacts;
  if (scene.controller.module_loss) json["module_losses"] = lossesJson(figures, scene);
  if (figures.further_losses > 0) json["further_module_losses"] = figures.further_losses;
  if (figures.unsensed) json["unsensed_contact"] = unsensedJson(*figures.unsensed, scene);
  if (figures.step_time_ns) json["step_time_ns"] = timesJson(*figures.step_time_ns);
}

}  // namespace

RunSummary::RunSummary(const ControllerConfig& config, std::size_t expected_cycles, FigureSet set)
    : limits_(config.limits),
      modules_(static_cast<int>(config.tactile_modules.size())),
      contacts_(config, expected_cycles, set),
      is_timed_(set == FigureSet::kAll) {
  if (config.task.hasRotation()) figures_.tcp_rotation_error.emplace();
}

void RunSummary::add(const CycleRecord& record) {
  addLosses(record);
  addFigures(record);
  for (const ContactFigures& contact : contacts_.add(record)) {
    if (figures_.contacts.size() < kMostContacts) {
      figures_.contacts.push_back(contact);
    } else {
      ++figures_.further_contacts;
    }
  }
}

void RunSummary::addFigures(const CycleRecord& record) noexcept {
  ++figures_.cycles;
  const double force_N = largestForce_N(record, modules_);
  if (force_N > figures_.peak_force_N) {
    figures_.peak_force_N = force_N;
    figures_.stiffness_at_peak_N_per_m = record.stiffness_N_per_m;
  }
  figures_.final_force_N = force_N;
  figures_.modules_lost = record.modules_lost;
  figures_.stiffness_final_N_per_m = record.stiffness_N_per_m;
  addToolError(record);
  addJoints(record);
  if (is_timed_) step_times_.add(record.step_ns);
}

/// Before the cycle's figures: those of the last one tell what is new.
void RunSummary::addLosses(const CycleRecord& record) {
  if (record.modules_lost == 0) return;
  std::vector<ModuleLoss>& losses = figures_.module_losses;
  for (int i = 0; i < modules_; ++i) {
    const std::uint64_t bit = std::uint64_t{1} << i;
    if ((record.modules_lost & bit) == 0) continue;
    if ((figures_.modules_lost & bit) == 0) {
      const bool is_listed = losses.size() < kMostLosses;
      if (is_listed) losses.push_back({i, record.t_s, record.t_s});
      if (!is_listed) ++figures_.further_losses;
      listed_losses_ = is_listed ? listed_losses_ | bit : listed_losses_ & ~bit;
    }
    if ((listed_losses_ & bit) == 0) continue;
    const auto last = std::find_if(losses.rbegin(), losses.rend(),
                                   [i](const ModuleLoss& loss) { return loss.module == i; });
    last->end_s = record.t_s;
  }
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
  for (const ContactFigures& contact : contacts_.present()) figures.contacts.push_back(contact);
  std::ranges::stable_sort(figures.contacts, {}, &ContactFigures::start_s);
  if (is_timed_) figures.step_time_ns = timeFigures(step_times_);
  return figures;
}

std::vector<std::string> lostModules(const Scene& scene, std::uint64_t modules_lost) {
  std::vector<std::string> links;
  for (std::size_t i = 0; i < scene.module_links.size(); ++i)
    if ((modules_lost >> i & 1U) != 0) links.push_back(scene.module_links[i]);
  return links;
}

Json summaryJson(const Scene& scene, const RunFigures& figures, double real_time_factor,
                 const HardwareFigures* hardware) {
  std::vector<std::string> stages = stageNames(scene.controller);
  if (hardware) {
    for (const std::string& stage : hardwareStageNames(*scene.hardware)) stages.push_back(stage);
  }
  Json json = {{"scene", scene.name}, {"variant", scene.variant}, {"stages", stages}};
  addTo(json, figures, scene);
  if (hardware) {
    json["loop"] = hardware->loop;
    json["log"] = logJson(hardware->log, "complete");
  }
  json["real_time_factor"] = real_time_factor;
  json["outcome"] = figures.end.fault == Fault::kNone ? "completed" : faultName(figures.end.fault);
  json["fault"] = faultJson(figures.end, scene);
  return json;
}

void writeSummary(const std::string& path, const Scene& scene, const RunFigures& figures,
                  double real_time_factor, const HardwareFigures* hardware) {
  OutputFile file(path);
  file.append(jsonText(summaryJson(scene, figures, real_time_factor, hardware)));
  file.close();
}

}  // namespace tactus
