#include "tactus/doctor/inspection.h"

#include <fmt/format.h>

#include "tactus/doctor/bus_checks.h"
#include "tactus/doctor/disk_check.h"
#include "tactus/doctor/interrupt_checks.h"
#include "tactus/doctor/kernel_checks.h"
#include "tactus/doctor/line_check.h"
#include "tactus/doctor/processor_checks.h"
#include "tactus/doctor/rights_checks.h"

namespace tactus {
namespace {

void append(std::vector<Finding>& findings, const std::vector<Finding>& more) {
  findings.insert(findings.end(), more.begin(), more.end());
}

/// The folder, or the nearest one above it that is there: it will be made on the same disk.
std::filesystem::path existingFolder(std::filesystem::path folder) {
  std::error_code ignored;
  while (folder.has_relative_path() && !std::filesystem::exists(folder, ignored))
    folder = folder.has_parent_path() ? folder.parent_path() : ".";
  return folder;
}

Finding inspectDisk(const MachineRoot& root, const MachineNeeds& needs) {
  const std::filesystem::path folder = existingFolder(root / needs.log_folder);
  std::error_code problem;
  const auto space = std::filesystem::space(folder, problem);
  if (!problem && std::filesystem::is_directory(folder, problem))
    return checkDisk(needs.log_folder, static_cast<double>(space.available), needs.log);
  return {"disk", Level::kNotFit,
          fmt::format("{}: cannot be made, {}", needs.log_folder.string(),
                      problem ? problem.message() : folder.string() + " is no folder"),
          "the daemon does not start without a folder for its log", "name another one with -o"};
}

}  // namespace

std::vector<Finding> inspectMachine(const MachineRoot& root, const MachineNeeds& needs) {
  const RealTimeConfig& real_time = needs.real_time;
  std::vector<Finding> findings = {
      checkPreemption(root),
      checkThrottling(root),
      checkControlGroup(root),
      checkProcessRights(root, real_time.priority),
      checkServiceRights(root, real_time.priority, hasRealTimeGroups(root)),
      checkGovernor(root, real_time.cpu),
      checkIsolation(root, real_time.cpu),
      checkLoopPriority(real_time.priority),
  };
  for (const BusConfig& bus : needs.buses) {
    append(findings, checkBus(root, bus, canLink(bus.interface)));
    append(findings, checkInterrupts(root, bus.interface, real_time.priority));
  }
  if (needs.gpio) findings.push_back(checkLines(surveyGpio(*needs.gpio)));
  findings.push_back(inspectDisk(root, needs));
  return findings;
}

}  // namespace tactus
