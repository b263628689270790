#pragma once

#include <atomic>

#include "tactus/daemon/control_cycle.h"
#include "tactus/daemon/cycle_record.h"
#include "tactus/rt/spsc_queue.h"

namespace tactus {

/// A cycle as the loop hands it on.
struct LoopRecord {
  CycleRecord cycle;
  bool is_in_motion = false;  ///< false: before the arm first moved; only the times count
};

/// All that passes between the loop and the telemetry: wait-free, and never waited for by the loop.
struct LoopLink {
  static constexpr std::size_t kRecords = 4096;  ///< four seconds at 1 kHz
  static constexpr std::size_t kReports = 256;

  SpscQueue<LoopRecord> records{kRecords};
  SpscQueue<ModeReport> reports{kReports};  ///< one for each change of mode or fault
  std::atomic<bool> stop_requested{false};
};

}  // namespace tactus
