#pragma once

#include <functional>
#include <vector>

#include "tactus/canopen/hardware_config.h"
#include "tactus/doctor/finding.h"
#include "tactus/math/histogram.h"

namespace tactus {

/// What a run of the loop on this machine was like.
struct LoopMeasurement {
  Histogram wake_latency, step;
  double period_s = 0.0;
  long long cycles = 0;
  long long missed_cycles = 0;  ///< skipped because the loop woke too late
  long long page_faults = 0;    ///< of the loop's thread, from its first cycle on
  std::vector<Finding> grants;  ///< what the machine granted to the loop, and what it refused
};

/// Runs `step` once a period, as the daemon runs its cycle: memory locked, CPUs awake, in a
/// SCHED_FIFO thread with the list of system calls. What is refused is left out. The step must not
/// throw, allocate or wait. Throws std::invalid_argument for a period that is none.
LoopMeasurement measureLoop(const RealTimeConfig& real_time, double period_s, double duration_s,
                            const std::function<void()>& step);

/// budget_s: what waking late and the step may take together in each cycle, so that frames still
/// get over the bus in time.
std::vector<Finding> judgeLoop(const LoopMeasurement& measured, double budget_s);

}  // namespace tactus
