#include "tactus/doctor/processor_checks.h"

#include <fmt/format.h>

namespace tactus {
namespace {

std::set<int> cpusIn(const MachineRoot& root, const std::string& file) {
  return cpuSet(readText(root / "sys/devices/system/cpu" / file).value_or(""));
}

Finding notAlone(const std::string& what, int cpu) {
  const std::string wanted = cpu == -1 ? "N" : std::to_string(cpu);
  return {"cpu_isolation", Level::kWarning, what,
          "the kernel puts other work, its timer tick and its deferred callbacks (RCU), for which "
          "sockets then wait, onto the loop's CPU",
          fmt::format("boot with isolcpus=managed_irq,domain,{0} nohz_full={0}{1}", wanted,
                      cpu == -1 ? ", and real_time: {cpu: N} in robot.yaml" : "")};
}

}  // namespace

Finding checkGovernor(const MachineRoot& root, int cpu) {
  const std::string name = "cpu_governor";
  std::set<int> slowing;
  std::string governor;
  bool has_governor = false;
  for (const int each : cpu == -1 ? cpusIn(root, "online") : std::set{cpu}) {
    const auto text = readText(root / fmt::format("sys/devices/system/cpu/cpu{}", each) /
                               "cpufreq/scaling_governor");
    if (!text) continue;
    has_governor = true;
    if (*text == "performance") continue;
    slowing.insert(each);
    governor = *text;
  }
  if (!slowing.empty())
    return {name, Level::kWarning,
            fmt::format("CPU {}: frequency governor {}", listOf(slowing), governor),
            "a step takes several times as long until the CPU has sped up",
            "echo performance | tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor"};
  return {name, Level::kOk,
          has_governor ? "frequency governor performance"
                       : "the kernel does not change the CPU's frequency"};
}

Finding checkIsolation(const MachineRoot& root, int cpu) {
  const std::set<int> isolated = cpusIn(root, "isolated");
  const std::set<int> tickless = cpusIn(root, "nohz_full");
  if (cpu == -1)
    return notAlone(
        isolated.empty()
            ? std::string("the loop may run on any CPU, none is isolated")
            : fmt::format("the loop may run on any CPU, isolated CPU {} unused", listOf(isolated)),
        cpu);
  if (!isolated.contains(cpu)) return notAlone(fmt::format("CPU {} is not isolated", cpu), cpu);
  if (!tickless.contains(cpu))
    return notAlone(fmt::format("CPU {} is isolated, but keeps its tick (nohz_full)", cpu), cpu);
  return {"cpu_isolation", Level::kOk, fmt::format("CPU {} is isolated and without tick", cpu)};
}

}  // namespace tactus
