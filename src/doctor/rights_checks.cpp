#include "tactus/doctor/rights_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <limits>

#include "tactus/doctor/unit_file.h"

namespace tactus {
namespace {

constexpr int kCapIpcLock = 14;  ///< lock memory beyond the limit
constexpr int kCapSysNice = 23;  ///< any scheduling

/// The value behind a label at the start of a line.
std::string_view lineOf(std::string_view text, std::string_view label) {
  for (const std::string_view line : split(text, "\n"))
    if (line.starts_with(label)) return line.substr(label.size());
  return {};
}

bool hasCapability(std::string_view status, int capability) {
  unsigned long long mask = 0;
  const auto words = split(lineOf(status, "CapEff:"));
  if (words.empty()) return false;
  std::from_chars(words[0].data(), words[0].data() + words[0].size(), mask, 16);
  return (mask >> capability & 1) != 0;
}

/// The soft one, as /proc/PID/limits has it.
std::string limitOf(std::string_view limits, std::string_view label) {
  const auto words = split(lineOf(limits, label));
  return words.empty() ? "unknown" : std::string(words[0]);
}

/// The soft part of a limit as systemd has it, "80" or "80:99"; absent: what it gives by itself.
bool allows(const std::string& limit, long long wanted) {
  const std::string soft = limit.substr(0, limit.find(':'));
  return soft == "infinity" || numberIn(soft).value_or(0) >= wanted;
}

/// Lines that the unit should have; "CPUQuota=" takes a value back.
std::vector<std::string> problemsOf(const UnitFile& unit, int priority, bool has_groups) {
  std::vector<std::string> problems;
  const std::string user = unit.value("User");
  const bool is_root = user.empty() ? !unit.isOn("DynamicUser") : user == "root" || user == "0";
  const auto may = [&](const char* capability) {
    return unit.mayHave(capability) && (is_root || unit.givesAmbient(capability));
  };
  if (!may("CAP_SYS_NICE") && !allows(unit.value("LimitRTPRIO"), priority))
    problems.push_back(fmt::format("LimitRTPRIO={}", priority));
  constexpr long long kUnlimited = std::numeric_limits<long long>::max();
  if (!may("CAP_IPC_LOCK") && !allows(unit.value("LimitMEMLOCK"), kUnlimited))
    problems.push_back("LimitMEMLOCK=infinity");
  if (unit.isOn("RestrictRealtime")) problems.push_back("RestrictRealtime=no");
  for (const char* key : {"CPUQuota", "CPUWeight"})
    if (has_groups && unit.isSet(key)) problems.push_back(fmt::format("{}=", key));
  return problems;
}

}  // namespace

Finding checkProcessRights(const MachineRoot& root, int priority) {
  const std::string status = readText(root / "proc/self/status").value_or("");
  const std::string limits = readText(root / "proc/self/limits").value_or("");
  const auto users = split(lineOf(status, "Uid:"));
  const std::string highest = limitOf(limits, "Max realtime priority");
  const std::string locked = limitOf(limits, "Max locked memory");
  const bool may_schedule = hasCapability(status, kCapSysNice);
  const bool may_lock = hasCapability(status, kCapIpcLock);
  const std::string what =
      fmt::format("this process, user {}: RLIMIT_RTPRIO {}{}, RLIMIT_MEMLOCK {}{}",
                  users.size() > 1 ? users[1] : "unknown", highest,
                  may_schedule ? " (CAP_SYS_NICE)" : "", locked, may_lock ? " (CAP_IPC_LOCK)" : "");
  const bool is_enough =
      (may_schedule || highest == "unlimited" || numberIn(highest).value_or(0) >= priority) &&
      (may_lock || locked == "unlimited");
  if (is_enough) return {"process_rights", Level::kOk, what};
  return {"process_rights", Level::kNote, what + ": not enough for the loop"};
}

Finding checkServiceRights(const MachineRoot& root, int priority,
                           const std::optional<bool>& has_real_time_groups) {
  const std::string name = "service_rights";
  const std::optional<UnitFile> unit = readUnit(root, "tactusd");
  if (!unit) return {name, Level::kNote, "tactusd is not installed as a service of systemd"};
  if (unit->is_masked)
    return {name, Level::kNotFit, unit->path + " is masked", "the service does not start",
            "systemctl unmask " + unit->name};
  const auto problems = problemsOf(*unit, priority, has_real_time_groups.value_or(false));
  if (problems.empty())
    return {name, Level::kOk, unit->path + " grants SCHED_FIFO and memory lock"};
  return {name, Level::kNotFit,
          fmt::format("{} should say {}", unit->path, fmt::join(problems, ", ")),
          "the service gets no real time, whatever this process got",
          fmt::format("systemctl edit {}, under [Service]: {}; then restart it", unit->name,
                      fmt::join(problems, ", "))};
}

}  // namespace tactus
