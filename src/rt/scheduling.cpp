#include "tactus/rt/scheduling.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <system_error>

namespace tactus {
namespace {

// On Linux, process 0 is the calling thread. The pthread functions would read back glibc's memory
// of what was set instead of asking the kernel.
constexpr pid_t kThisThread = 0;

int setAffinity(int cpu) noexcept {
  if (cpu == -1) return 0;
  if (cpu < 0 || cpu >= CPU_SETSIZE) return EINVAL;
  cpu_set_t wanted, actual;
  CPU_ZERO(&wanted);
  CPU_SET(static_cast<unsigned>(cpu), &wanted);
  if (sched_setaffinity(kThisThread, sizeof wanted, &wanted) != 0) return errno;
  if (sched_getaffinity(kThisThread, sizeof actual, &actual) != 0) return errno;
  return CPU_EQUAL(&wanted, &actual) ? 0 : kNotReadBack;
}

int setFifo(int priority) noexcept {
  sched_param wanted{}, actual{};
  wanted.sched_priority = priority;
  if (sched_setscheduler(kThisThread, SCHED_FIFO, &wanted) != 0) return errno;
  if (sched_getparam(kThisThread, &actual) != 0) return errno;
  const bool is_fifo = sched_getscheduler(kThisThread) == SCHED_FIFO;
  return is_fifo && actual.sched_priority == priority ? 0 : kNotReadBack;
}

std::string reason(int error) {
  return error == kNotReadBack ? "accepted, but not in effect"
                               : std::generic_category().message(error);
}

Refusal affinityRefusal(int cpu, int error) {
  return {"running on CPU " + std::to_string(cpu) + " alone: " + reason(error),
          "a loop that moves between CPUs loses its caches and meets other work",
          "name a CPU that this process may use (see 'taskset -p $$'; AllowedCPUs= in the systemd "
          "unit, --cpuset-cpus of a container), or -1 for any"};
}

Refusal policyRefusal(int priority, int error) {
  rlimit limit{};
  getrlimit(RLIMIT_RTPRIO, &limit);
  Refusal refusal{"SCHED_FIFO at priority " + std::to_string(priority) + ": " + reason(error),
                  "any other process can then delay a cycle by many milliseconds", ""};
  if (error == EINVAL) {
    refusal.how_to_grant = "choose a priority from 1 to 99";
    return refusal;
  }
  const std::string wanted = std::to_string(priority);
  refusal.how_to_grant =
      "LimitRTPRIO=" + wanted + " in the systemd unit, or 'USER - rtprio " + wanted +
      "' in /etc/security/limits.d/, or CAP_SYS_NICE in a container (RLIMIT_RTPRIO is " +
      std::to_string(limit.rlim_cur) +
      "); if that is granted already, the kernel has RT_GROUP_SCHED and this control group no "
      "real-time budget: remove CPUQuota= and CPUWeight= from the unit and its slices";
  return refusal;
}

Refusal latencyRefusal(const std::string& path, int error) {
  return {"holding " + path + ": " + reason(error),
          "an idle CPU takes up to hundreds of microseconds to wake",
          error == ENOENT ? "pass the device into the container; on a kernel without it, boot with "
                            "processor.max_cstate=1 intel_idle.max_cstate=0"
                          : "a udev rule: KERNEL==\"cpu_dma_latency\", GROUP=\"tactus\", "
                            "MODE=\"0660\", and the user in that group"};
}

}  // namespace

RealTimeOutcome applyRealTime(const RealTimeRequest& request) noexcept {
  return {setAffinity(request.cpu), setFifo(request.priority)};
}

std::vector<Refusal> realTimeRefusals(const RealTimeRequest& request,
                                      const RealTimeOutcome& outcome) {
  std::vector<Refusal> refusals;
  if (outcome.affinity_error != 0) {
    refusals.push_back(affinityRefusal(request.cpu, outcome.affinity_error));
  }
  if (outcome.policy_error != 0) {
    refusals.push_back(policyRefusal(request.priority, outcome.policy_error));
  }
  return refusals;
}

CpuLatencyHold::CpuLatencyHold(const char* path) {
  const std::int32_t highest_latency_us = 0;
  descriptor_ = open(path, O_WRONLY | O_CLOEXEC);
  if (descriptor_ < 0 || write(descriptor_, &highest_latency_us, sizeof highest_latency_us) < 0) {
    refusal_ = latencyRefusal(path, errno);
  }
}

CpuLatencyHold::~CpuLatencyHold() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace tactus
