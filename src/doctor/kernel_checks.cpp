#include "tactus/doctor/kernel_checks.h"

#include <fmt/format.h>

#include <algorithm>

namespace tactus {
namespace {

struct ControlGroup {
  std::filesystem::path folder;
  bool is_unified = false;  ///< version 2
};

/// Where the group of this process has its cpu controller: of version 1 if that has it, else of 2.
ControlGroup cpuGroup(const MachineRoot& root) {
  const MachineRoot groups = root / "sys/fs/cgroup";
  ControlGroup unified;
  const std::string table = readText(root / "proc/self/cgroup").value_or("");
  for (const std::string_view line : split(table, "\n")) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == line.npos || second == line.npos) continue;
    const std::string_view controllers = line.substr(first + 1, second - first - 1);
    const auto path = std::filesystem::path(line.substr(second + 1)).relative_path();
    if (std::ranges::count(split(controllers, ","), std::string_view("cpu")) > 0)
      return {groups / controllers / path, false};
    if (controllers.empty()) unified = {groups / path, true};
  }
  return unified;
}

std::string releaseOf(const MachineRoot& root) {
  return readText(root / "proc/sys/kernel/osrelease").value_or("unknown");
}

/// "6.12.3-rt" is from 6.12 on.
bool isFrom(const std::string& release, int major, int minor) {
  const auto numbers = split(release, ".-+");
  if (numbers.size() < 2) return false;
  const long long first = numberIn(numbers[0]).value_or(0);
  return first > major || (first == major && numberIn(numbers[1]).value_or(0) >= minor);
}

/// A kernel that has the parameter has its default among its settings, on or off.
bool areGroupsSwitchedOff(const MachineRoot& root, const std::string& config) {
  const std::string name = "CONFIG_RT_GROUP_SCHED_DEFAULT_DISABLED";
  if (config.find(name) == std::string::npos) return false;
  const std::string parameters = readText(root / "proc/cmdline").value_or("");
  bool is_off = config.find(name + "=y") != std::string::npos;
  for (const std::string_view word : split(parameters, " \n"))
    if (word.starts_with("rt_group_sched=")) is_off = word.ends_with("=0");
  return is_off;
}

/// Linux 6.12 replaced the throttling, but for real-time groups, by a server for all other threads
/// that takes its share of a CPU where they starve.
Finding fairServer(const std::string& release) {
  return {"rt_throttling", Level::kNote,
          release +
              ": sched_rt_runtime_us throttles no thread, but a real-time thread that is "
              "busy too long is interrupted by the fair server (50 ms of a second; "
              "/sys/kernel/debug/sched/fair_server)"};
}

}  // namespace

Finding checkPreemption(const MachineRoot& root) {
  const std::string release = releaseOf(root);
  const std::string version = readText(root / "proc/sys/kernel/version").value_or("");
  const bool is_realtime = readNumber(root / "sys/kernel/realtime") == 1 ||
                           version.find("PREEMPT_RT") != std::string::npos;
  if (is_realtime) return {"kernel", Level::kOk, fmt::format("{}, PREEMPT_RT", release)};
  return {"kernel", Level::kNotFit,
          fmt::format("{} is no PREEMPT_RT kernel ({})", release, version),
          "while the kernel works for others it may delay a cycle without bound",
          "apt install linux-image-rt-amd64, and boot it"};
}

Finding checkThrottling(const MachineRoot& root) {
  const std::string name = "rt_throttling";
  const auto runtime_us = readNumber(root / "proc/sys/kernel/sched_rt_runtime_us");
  const auto period_us = readNumber(root / "proc/sys/kernel/sched_rt_period_us");
  const std::string command =
      "sysctl -w kernel.sched_rt_runtime_us=-1, and kernel.sched_rt_runtime_us=-1 in "
      "/etc/sysctl.d/tactus.conf";
  if (!runtime_us || !period_us)
    return {name, Level::kNote, "the kernel does not tell its sched_rt_runtime_us"};
  if (*runtime_us == 0)
    return {name, Level::kNotFit, "sched_rt_runtime_us = 0", "no real-time thread may run",
            command};
  const std::string release = releaseOf(root);
  if (isFrom(release, 6, 12) && !hasRealTimeGroups(root).value_or(false))
    return fairServer(release);
  if (*runtime_us < 0 || *runtime_us >= *period_us)
    return {name, Level::kOk, "real-time threads are not throttled"};
  return {name, Level::kWarning,
          fmt::format("sched_rt_runtime_us = {} of {}", *runtime_us, *period_us),
          fmt::format("a real-time thread that is busy too long stops all on its CPU, the loop "
                      "included, for {} ms",
                      (*period_us - *runtime_us) / 1000),
          command};
}

std::optional<bool> hasRealTimeGroups(const MachineRoot& root) {
  if (std::filesystem::exists(root / "sys/fs/cgroup/cpu/cpu.rt_runtime_us")) return true;
  const auto config = readText(root / "boot" / ("config-" + releaseOf(root)));
  if (!config) return std::nullopt;
  return config->find("\nCONFIG_RT_GROUP_SCHED=y") != std::string::npos &&
         !areGroupsSwitchedOff(root, *config);
}

Finding checkControlGroup(const MachineRoot& root) {
  const std::string name = "rt_group_budget";
  const std::string why = "SCHED_FIFO is refused (EPERM) whatever the limits say";
  const ControlGroup group = cpuGroup(root);
  std::error_code none;
  if (group.is_unified && std::filesystem::exists(group.folder / "cpu.max", none)) {
    const std::optional<bool> has_groups = hasRealTimeGroups(root);
    if (!has_groups)
      return {name, Level::kNote,
              "this control group has the cpu controller on, and /boot/config-* does not tell "
              "whether the kernel has RT_GROUP_SCHED"};
    if (*has_groups)
      return {name, Level::kNotFit,
              "this control group has the cpu controller on and the kernel RT_GROUP_SCHED: no "
              "real-time budget",
              why,
              "remove CPUQuota= and CPUWeight= from the unit and its slices, or boot with "
              "rt_group_sched=0"};
  }
  if (!group.is_unified && readNumber(group.folder / "cpu.rt_runtime_us") == 0)
    return {name, Level::kNotFit, "this control group has cpu.rt_runtime_us = 0", why,
            "echo 950000 > " + (group.folder / "cpu.rt_runtime_us").string() +
                ", in each group above it first"};
  return {name, Level::kOk, "this control group may have real-time threads"};
}

}  // namespace tactus
