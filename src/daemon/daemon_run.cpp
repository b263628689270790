#include "tactus/daemon/daemon_run.h"

#include <fmt/format.h>
#include <signal.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>

#include "tactus/daemon/control_socket.h"
#include "tactus/daemon/hardware_loop.h"
#include "tactus/daemon/service_watchdog.h"
#include "tactus/daemon/stop_signals.h"
#include "tactus/daemon/telemetry.h"
#include "tactus/record/message.h"
#include "tactus/record/run_error.h"
#include "tactus/record/run_folder.h"
#include "tactus/rt/memory.h"
#include "tactus/rt/periodic_thread.h"
#include "tactus/rt/scheduling.h"
#include "tactus/rt/system_call_filter.h"

namespace tactus {
namespace {

/// For the telemetry, which allocates while the loop runs.
constexpr std::size_t kHeapBytes = std::size_t{16} << 20;
constexpr std::chrono::milliseconds kDrainPeriod{20};

/// SIGINT, SIGQUIT and SIGTSTP of a terminal all bring the arm to rest.
void blockStopSignals() noexcept {
  const sigset_t signals = stopSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

std::atomic<bool>* stop_requested_by_signal = nullptr;

void onStopSignal(int) { stop_requested_by_signal->store(true, std::memory_order_relaxed); }

/// Lets stop signals reach the loop, even while this thread waits for a disk or a terminal; all
/// other threads keep them blocked. Whatever ends the telemetry, the loop must not go on alone: its
/// thread is waited for.
class StopRequests {
 public:
  explicit StopRequests(std::atomic<bool>& stop_requested) : stop_requested_(stop_requested) {
    stop_requested_by_signal = &stop_requested;
    struct sigaction action {};
    action.sa_handler = onStopSignal;
    action.sa_flags = SA_RESTART;
    for (const int signal : kStopSignals) sigaction(signal, &action, nullptr);
    const sigset_t signals = stopSignals();
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  }
  ~StopRequests() {
    blockStopSignals();
    stop_requested_.store(true, std::memory_order_relaxed);
  }
  StopRequests(const StopRequests&) = delete;
  StopRequests& operator=(const StopRequests&) = delete;

 private:
  std::atomic<bool>& stop_requested_;
};

std::int64_t processTime_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

/// What waits in a long queue is old when it gets onto the bus, and a short one loses frames.
void warnOfQueues(const HardwareConfig& hardware) {
  for (std::size_t i = 0; i < hardware.buses.size(); ++i) {
    const std::string& interface = hardware.buses[i].interface;
    const auto drives = std::ranges::count(hardware.drives, static_cast<int>(i), &DriveConfig::bus);
    const int length = transmitQueueLength(interface);
    const int wanted = transmitQueueFor(static_cast<int>(drives));
    if (length <= kMaxTransmitQueue && (wanted < kMaxTransmitQueue || length >= wanted)) continue;
    fmt::print(stderr,
               "tactusd: {}: transmit queue of {} frames; better: ip link set {} txqueuelen {}\n",
               interface, length, interface, wanted);
  }
}

/// A machine that is not fit for real time is refused unless the scene does without.
void judgeRefusals(const std::vector<Refusal>& refusals, bool is_required) {
  std::string text;
  for (const Refusal& refusal : refusals)
    text += fmt::format("{}{}: {}; to grant it: {}", text.empty() ? "" : "\n", refusal.what,
                        refusal.why_it_matters, refusal.how_to_grant);
  if (refusals.empty()) return;
  if (is_required)
    throw RunError(text +
                   "\nno real time, so nothing moves; a scene may do without it by "
                   "real_time: {required: false}");
  fmt::print(stderr, "{}\ntactusd: goes on without, as the scene says\n", text);
}

std::unique_ptr<HardwareLoop> openHardware(const Scene& scene, double duration_s,
                                           const SystemCallFilter& filter, LoopLink& link) {
  const long long max_task_cycles = motionCycles(duration_s, scene.period_s);
  try {
    return std::make_unique<HardwareLoop>(scene, max_task_cycles, filter, link);
  } catch (const std::runtime_error& error) {
    throw RunError(error.what());
  }
}

void nameForbiddenCall(const SystemCallFilter& filter) {
  const ForbiddenCalls calls = filter.forbiddenCalls();
  if (calls.count == 0) return;
  say("the loop made {} forbidden system calls, first {}", calls.count,
      systemCallName(calls.first));
}

LoopFigures loopFigures(const Scene& scene, const HardwareLoop& loop, const LoopLink& link,
                        const PeriodicThread& thread, std::int64_t process_ns) {
  LoopFigures figures;
  const auto cycles = static_cast<double>(loop.cycles());
  figures.cycles = loop.cycles();
  figures.missed_cycles = loop.missedCycles();
  figures.dropped_records = static_cast<long long>(link.records.dropped());
  figures.page_faults = thread.pageFaults().minor + thread.pageFaults().major;
  figures.cpu_ns_per_cycle = static_cast<double>(loop.cpuTime_ns()) / cycles;
  figures.process_cpu_ns_per_cycle = static_cast<double>(process_ns) / cycles;
  for (std::size_t i = 0; i < loop.buses(); ++i)
    figures.buses.push_back({scene.hardware->buses[i].interface, loop.counters(i)});
  const CanRobot& robot = loop.robot();
  figures.malformed_drive_frames = robot.malformedFrames();
  const auto modules = robot.tactileModules();
  for (std::size_t i = 0; i < modules.size(); ++i)
    figures.tactile_modules.push_back({scene.module_links[i], modules[i].counters()});
  return figures;
}

}  // namespace

long long motionCycles(double duration_s, double period_s) noexcept {
  return duration_s > 0.0 ? std::max(1LL, std::llround(duration_s / period_s)) : 0;
}

Fault runDaemon(const Scene& scene, const DaemonOptions& options) {
  blockStopSignals();
  signal(SIGPIPE, SIG_IGN);  // whoever reads the messages may leave; the arm still ends at rest
  signal(SIGTTOU, SIG_IGN);  // a message from the background must not suspend it
  signal(SIGXFSZ, SIG_IGN);  // a log beyond the limit of a file's size is an error of write() alone
  const RealTimeConfig& real_time = scene.hardware->real_time;

  SystemCallFilter filter(kLoopSystemCalls);
  LoopLink link;
  const auto loop = openHardware(scene, options.duration_s, filter, link);
  warnOfQueues(*scene.hardware);

  std::vector<Refusal> refusals;
  if (auto refusal = lockMemory(kHeapBytes)) refusals.push_back(*refusal);
  const CpuLatencyHold latency_hold;
  if (latency_hold.refusal()) refusals.push_back(*latency_hold.refusal());
  // Before the loop's thread, and so after its end: whatever ends this function, a ramp to rest may
  // last.
  const ServiceWatchdog watchdog(link.pulse, real_time.max_late_cycles);
  PeriodicThreadConfig config;
  config.period_ns = std::llround(1e9 * scene.period_s);
  config.real_time = {real_time.priority, real_time.cpu};
  config.filter = &filter;
  PeriodicThread thread(config, [&](const Wake& wake) noexcept { return loop->cycle(wake); });
  refusals.insert(refusals.end(), thread.refusals().begin(), thread.refusals().end());
  judgeRefusals(refusals, real_time.required);
  // While stop signals are blocked, so that its thread never gets one.
  const ControlSocket control(scene, link);
  // A run that is refused leaves no files, and those of the run before.
  std::optional<RunFolder> folder;
  if (!options.folder.empty()) folder.emplace(options.folder, options.name);
  Telemetry telemetry(scene, folder ? folder->path().string() : "", link);

  const std::int64_t process_start_ns = processTime_ns();
  thread.start();
  const StopRequests stop_requests(link.stop_requested);
  while (!link.pulse.has_ended.load(std::memory_order_acquire)) {
    std::this_thread::sleep_for(kDrainPeriod);
    telemetry.drain();
  }
  thread.join();
  telemetry.drain();
  nameForbiddenCall(filter);
  const FaultReport& end = loop->report();
  telemetry.finish(
      {end, loopFigures(scene, *loop, link, thread, processTime_ns() - process_start_ns)});
  return end.fault;
}

}  // namespace tactus
