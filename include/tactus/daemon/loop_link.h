#pragma once

#include <atomic>
#include <cstdint>

#include "tactus/rt/newest_value.h"
#include "tactus/rt/spsc_queue.h"
#include "tactus/supervisor/control_cycle.h"
#include "tactus/supervisor/cycle_record.h"

namespace tactus {

/// A cycle as the loop hands it on.
struct LoopRecord {
  CycleRecord cycle;          ///< tool_error_m is the telemetry's to fill in
  bool is_in_motion = false;  ///< false: before the arm first moved; only the times count
};

/// What the loop shows of itself each cycle to those who watch over it.
struct LoopPulse {
  std::atomic<std::int64_t> cycles{0};
  std::atomic<std::int64_t> missed_cycles{0};
  std::atomic<std::int64_t> late_in_a_row{0};  ///< cycles up to the last one; 0: on time
  std::atomic<WayOn> way_on{WayOn{}};
  static_assert(std::atomic<WayOn>::is_always_lock_free);
  std::atomic<bool> has_ended{false};  ///< with its last cycle
};

/// All that passes between the loop and other threads: wait-free, and never waited for by the loop.
struct LoopLink {
  static constexpr std::size_t kRecords = 4096;  ///< four seconds at 1 kHz
  static constexpr std::size_t kReports = 256;
  static constexpr std::size_t kToolOrders = 512;

  SpscQueue<LoopRecord> records{kRecords};
  SpscQueue<ModeReport> reports{kReports};  ///< one for each change of mode or fault
  NewestValue<GainOrder> gain_orders;
  NewestValue<GainReport> gain_reports;           ///< each time that one is new
  SpscQueue<ToolOrder> tool_orders{kToolOrders};  ///< all but holds
  NewestValue<ToolOrder> tool_holds;              ///< which wait behind no other order
  NewestValue<ToolSight> tool_sights;             ///< of tasks by command, many times a second
  LoopPulse pulse;
  std::atomic<bool> stop_requested{false};
};

}  // namespace tactus
