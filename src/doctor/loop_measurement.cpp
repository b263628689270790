#include "tactus/doctor/loop_measurement.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "tactus/rt/memory.h"
#include "tactus/rt/periodic_thread.h"
#include "tactus/rt/periodic_timer.h"
#include "tactus/rt/scheduling.h"
#include "tactus/rt/system_call_filter.h"

namespace tactus {
namespace {

constexpr std::size_t kHeapBytes = std::size_t{16} << 20;  ///< as the daemon

void note(std::vector<Finding>& grants, const char* name, const char* granted,
          const std::optional<Refusal>& refusal) {
  grants.push_back(refusal ? findingOf(name, *refusal) : Finding{name, Level::kOk, granted});
}

void noteThread(std::vector<Finding>& grants, const RealTimeConfig& real_time,
                const std::vector<Refusal>& refusals) {
  for (const Refusal& refusal : refusals) grants.push_back(findingOf("loop_thread", refusal));
  if (!refusals.empty()) return;
  const std::string cpu =
      real_time.cpu == -1 ? "any CPU" : "CPU " + std::to_string(real_time.cpu) + " alone";
  grants.push_back({"loop_thread", Level::kOk,
                    fmt::format("granted to this process: SCHED_FIFO at priority {} on {}",
                                real_time.priority, cpu)});
}

double microseconds(std::int64_t time_ns) { return 1e-3 * static_cast<double>(time_ns); }

}  // namespace

LoopMeasurement measureLoop(const RealTimeConfig& real_time, double period_s, double duration_s,
                            const std::function<void()>& step) {
  LoopMeasurement measured;
  measured.period_s = period_s;
  note(measured.grants, "memory_lock", "granted to this process: all memory locked",
       lockMemory(kHeapBytes));
  const CpuLatencyHold latency_hold;
  note(measured.grants, "cpu_latency", "granted to this process: CPUs stay out of deep idle states",
       latency_hold.refusal());

  SystemCallFilter filter(kLoopSystemCalls);
  PeriodicThreadConfig config;
  config.period_ns = std::llround(1e9 * period_s);
  config.real_time = {real_time.priority, real_time.cpu};
  config.filter = &filter;
  const long long cycles = std::llround(duration_s / period_s);
  PeriodicThread thread(config, [&](const Wake& wake) noexcept {
    const std::int64_t woken_ns = now_ns();
    step();
    measured.step.add(now_ns() - woken_ns);
    measured.wake_latency.add(wake.latency_ns);
    measured.missed_cycles += wake.skipped;
    return ++measured.cycles + measured.missed_cycles < cycles;
  });
  noteThread(measured.grants, real_time, thread.refusals());
  thread.start();
  thread.join();
  measured.page_faults = thread.pageFaults().minor + thread.pageFaults().major;
  return measured;
}

std::vector<Finding> judgeLoop(const LoopMeasurement& measured, double budget_s) {
  const std::string cause =
      "mend what is named above first; then look for firmware interrupts (hwlatdetect) and, in a "
      "virtual machine, for its host";
  std::vector<Finding> findings;
  const double worst_us =
      microseconds(measured.wake_latency.max_ns()) + microseconds(measured.step.max_ns());
  const std::string what = fmt::format(
      "at worst {:.1f} us for waking late and the step together, of {:.1f} us that a "
      "cycle of {:g} us has for them",
      worst_us, 1e6 * budget_s, 1e6 * measured.period_s);
  if (measured.missed_cycles > 0) {
    findings.push_back({"loop_time", Level::kNotFit,
                        fmt::format("{} of {} cycles missed; {}", measured.missed_cycles,
                                    measured.cycles + measured.missed_cycles, what),
                        "the arm goes on with its last command while the loop sleeps", cause});
  } else if (worst_us > 1e6 * budget_s) {
    findings.push_back({"loop_time", Level::kWarning, what,
                        "feedback of the drives then comes a cycle late", cause});
  } else {
    findings.push_back({"loop_time", Level::kOk, what});
  }
  if (measured.page_faults > 0)
    findings.push_back({"page_faults", Level::kWarning,
                        fmt::format("{} page faults in the loop", measured.page_faults),
                        "each delays a cycle by microseconds to many milliseconds",
                        "grant the memory lock"});
  return findings;
}

}  // namespace tactus
