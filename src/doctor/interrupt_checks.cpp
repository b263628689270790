#include "tactus/doctor/interrupt_checks.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactus/doctor/kernel_checks.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

constexpr int kInterruptPriority = 50;  ///< what the kernel gives to every interrupt thread

/// Rows of /proc/interrupts, "33: ... can0" or "33: ... can0, can1", that name the interface.
std::set<int> interruptsNamed(const MachineRoot& root, const std::string& interface) {
  std::set<int> interrupts;
  const std::string table = readText(root / "proc/interrupts").value_or("");
  for (const std::string_view row : split(table, "\n")) {
    const auto words = split(row, " \t,");
    if (words.empty() || !words[0].ends_with(':')) continue;
    const auto number = numberIn(words[0].substr(0, words[0].size() - 1));
    if (number && std::ranges::count(words, interface) > 0)
      interrupts.insert(static_cast<int>(*number));
  }
  return interrupts;
}

/// Of a device: by messages (MSI), else by its line.
std::set<int> interruptsOf(const fs::path& device) {
  std::set<int> interrupts;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(device / "msi_irqs", none))
    if (const auto number = numberIn(entry.path().filename().string()))
      interrupts.insert(static_cast<int>(*number));
  const auto line = readNumber(device / "irq");
  if (interrupts.empty() && line && *line > 0) interrupts.insert(static_cast<int>(*line));
  return interrupts;
}

/// Drivers that call their interrupt by another name are found by the device, or by the next one
/// on the way to the processor that has any: a USB adapter by its host controller.
std::set<int> interruptsOf(const MachineRoot& root, const std::string& interface) {
  const std::set<int> named = interruptsNamed(root, interface);
  if (!named.empty()) return named;
  std::error_code none;
  const fs::path top = fs::canonical(root / "sys", none);
  fs::path device = fs::canonical(root / "sys/class/net" / interface / "device", none);
  for (; device.has_relative_path() && device != top; device = device.parent_path()) {
    const std::set<int> interrupts = interruptsOf(device);
    if (!interrupts.empty()) return interrupts;
  }
  return {};
}

struct InterruptThread {
  int process_id = 0;
  std::string name;
  int priority = 0;
};

/// Field 40 of /proc/PID/stat, the real-time priority, counted behind the name: that may hold
/// spaces.
int priorityOf(const fs::path& process) {
  const std::string text = readText(process / "stat").value_or("");
  const auto fields = split(std::string_view(text).substr(std::min(text.rfind(')'), text.size())));
  constexpr std::size_t kPriority = 40 - 2;
  return fields.size() > kPriority ? static_cast<int>(numberIn(fields[kPriority]).value_or(0)) : 0;
}

std::vector<InterruptThread> threadsOf(const MachineRoot& root, const std::set<int>& interrupts) {
  std::vector<InterruptThread> threads;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(root / "proc", none)) {
    const auto process_id = numberIn(entry.path().filename().string());
    if (!process_id) continue;
    const std::string name = readText(entry.path() / "comm").value_or("");
    if (!name.starts_with("irq/")) continue;
    const auto number = numberIn(std::string_view(name).substr(4, name.find('-') - 4));
    if (number && interrupts.contains(static_cast<int>(*number)))
      threads.push_back({static_cast<int>(*process_id), name, priorityOf(entry.path())});
  }
  std::ranges::sort(threads, {}, &InterruptThread::process_id);
  return threads;
}

Finding judge(const std::string& interface, const InterruptThread& thread, int loop_priority) {
  const std::string name = "can_interrupts";
  const std::string what = fmt::format("{}: interrupt thread {} has priority {}, the loop {}",
                                       interface, thread.name, thread.priority, loop_priority);
  const std::string mend = fmt::format("chrt -f -p {} {}, after each start of the interface",
                                       loop_priority - 1, thread.process_id);
  if (thread.priority >= loop_priority)
    return {name, Level::kWarning, what, "a flood of frames can keep the loop from running", mend};
  if (thread.priority > kInterruptPriority) return {name, Level::kOk, what};
  return {name, Level::kWarning, what,
          "interrupts of disk and network have the same priority and can delay frames", mend};
}

}  // namespace

Finding checkLoopPriority(int loop_priority) {
  const std::string what = fmt::format("the loop has priority {}", loop_priority);
  // One place has to be left between both, for CAN.
  if (loop_priority > kInterruptPriority + 1) return {"loop_priority", Level::kOk, what};
  return {"loop_priority", Level::kWarning,
          fmt::format("{}, interrupt threads {}", what, kInterruptPriority),
          "interrupts of disk and network go before the loop, or before its CAN frames",
          "real_time: {priority: 80} in robot.yaml"};
}

std::vector<Finding> checkInterrupts(const MachineRoot& root, const std::string& interface,
                                     int loop_priority) {
  std::error_code none;
  if (!fs::exists(root / "sys/class/net" / interface / "device", none)) return {};
  const std::set<int> interrupts = interruptsOf(root, interface);
  if (interrupts.empty())
    return {{"can_interrupts", Level::kNote,
             interface + ": its interrupt was not found, so neither its priority"}};
  const std::vector<InterruptThread> threads = threadsOf(root, interrupts);
  // There every handler of a driver has a thread, which is made once the interface is up, and which
  // /proc may hide.
  if (threads.empty() && checkPreemption(root).level == Level::kOk)
    return {{"can_interrupts", Level::kNote,
             fmt::format("{}: the thread of interrupt {} was not found, so neither its priority",
                         interface, listOf(interrupts))}};
  if (threads.empty())
    return {{"can_interrupts", Level::kOk,
             fmt::format("{}: interrupt {} has no thread, it goes before all threads", interface,
                         listOf(interrupts))}};
  std::vector<Finding> findings;
  for (const InterruptThread& thread : threads)
    findings.push_back(judge(interface, thread, loop_priority));
  return findings;
}

}  // namespace tactus
