/// The daemon's loop on real buses, leaving its list of system calls while the arm moves:
///
///     forbidden_call_check SCENE
///
/// Prints the wall clock's time of the call, to be compared with candump's.
/// Exit status: 0 if the kernel refused the call and the loop ended by the fault for it, else 1.

#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "tactus/daemon/hardware_loop.h"
#include "tactus/daemon/telemetry.h"
#include "tactus/rt/memory.h"
#include "tactus/rt/periodic_thread.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

constexpr int kMovingCycles = 600;
constexpr std::size_t kHeapBytes = std::size_t{1} << 20;

/// Calls once, as a library would that nobody has looked into.
class Offender {
 public:
  void afterCycle(const ModeReport& report) noexcept {
    if (report.mode != Mode::kRunning || ++cycles_ != kMovingCycles) return;
    clock_gettime(CLOCK_REALTIME, &time_);
    result_ = syscall(SYS_getpid);
  }
  bool wasRefused() const noexcept { return result_ == -1; }
  timespec time() const noexcept { return time_; }

 private:
  timespec time_{};
  int cycles_ = 0;
  long result_ = 0;
};

bool endsAtRest(const char* path) {
  const Scene scene = loadScene(path, {});
  if (!scene.hardware) throw std::runtime_error("the scene has no hardware");
  SystemCallFilter filter(kLoopSystemCalls);
  LoopLink link;
  HardwareLoop loop(scene, 0, filter, link);
  Telemetry telemetry(scene, "", link);
  lockMemory(kHeapBytes);
  Offender offender;
  std::atomic<bool> has_ended{false};
  PeriodicThreadConfig config;
  config.real_time = {scene.hardware->real_time.priority, scene.hardware->real_time.cpu};
  config.filter = &filter;
  PeriodicThread thread(config, [&](const Wake& wake) noexcept {
    const bool goes_on = loop.cycle(wake);
    offender.afterCycle(loop.report());
    if (!goes_on) has_ended = true;
    return goes_on;
  });
  thread.start();
  while (!has_ended) {
    usleep(10'000);
    telemetry.drain();
  }
  thread.join();
  telemetry.drain();
  const ForbiddenCalls calls = filter.forbiddenCalls();
  const timespec time = offender.time();
  std::printf("(%lld.%09ld) %u forbidden calls, first: %s\n", static_cast<long long>(time.tv_sec),
              time.tv_nsec, calls.count, systemCallName(calls.first).c_str());
  return offender.wasRefused() && calls.count == 1 && calls.first == SYS_getpid &&
         loop.report().fault == Fault::kForbiddenSystemCall;
}

}  // namespace
}  // namespace tactus

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: forbidden_call_check SCENE\n");
    return 2;
  }
  try {
    return tactus::endsAtRest(argv[1]) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
