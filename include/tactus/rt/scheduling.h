#pragma once

#include <optional>
#include <vector>

#include "tactus/rt/refusal.h"

namespace tactus {

struct RealTimeRequest {
  int priority = 80;  ///< of SCHED_FIFO, 1 to 99
  int cpu = -1;       ///< the only one to run on; -1: any
};

/// errno of each step; 0: granted, and read back as requested.
struct RealTimeOutcome {
  int affinity_error = 0;
  int policy_error = 0;
};

/// An "errno" of our own: the kernel accepted the request, but what it reads back differs.
inline constexpr int kNotReadBack = -1;

/// For the calling thread alone. Allocates nothing, so that the thread owns no heap when it ends.
RealTimeOutcome applyRealTime(const RealTimeRequest& request) noexcept;

/// One for each step that was refused.
std::vector<Refusal> realTimeRefusals(const RealTimeRequest& request,
                                      const RealTimeOutcome& outcome);

/// Keeps all CPUs out of idle states that take long to leave, for as long as it lives.
class CpuLatencyHold {
 public:
  explicit CpuLatencyHold(const char* path = "/dev/cpu_dma_latency");
  ~CpuLatencyHold();
  CpuLatencyHold(const CpuLatencyHold&) = delete;
  CpuLatencyHold& operator=(const CpuLatencyHold&) = delete;

  const std::optional<Refusal>& refusal() const noexcept { return refusal_; }

 private:
  int descriptor_ = -1;
  std::optional<Refusal> refusal_;
};

}  // namespace tactus
