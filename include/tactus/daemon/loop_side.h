#pragma once

#include <cstdint>

#include "tactus/daemon/loop_link.h"
#include "tactus/rt/periodic_schedule.h"
#include "tactus/supervisor/control_cycle.h"

namespace tactus {

/// How long the parts of a cycle took.
struct LoopTimes {
  std::int64_t read_ns = 0, control_ns = 0, write_ns = 0;
};

/// The loop's side of a LoopLink, for loops on hardware and in virtual time.
class LoopSide {
 public:
  explicit LoopSide(LoopLink& link) noexcept : link_(link) {}

  /// After a cycle's frames have been sent: hands on what it was, takes what was ordered meanwhile,
  /// and does ahead what the next one needs.
  void finish(const Wake& wake, const LoopTimes& times, ControlCycle& cycle) noexcept;

  long long cycles() const noexcept { return cycles_; }
  long long missedCycles() const noexcept { return missed_cycles_; }

 private:
  void publish(const Wake& wake, const LoopTimes& times, const ControlCycle& cycle) noexcept;
  void takeOrders(ControlCycle& cycle) noexcept;
  bool takeOrder(const ToolOrder& order, ControlCycle& cycle) noexcept;
  void reportGains(const ControlCycle& cycle) noexcept;
  void reportTool(const ControlCycle& cycle) noexcept;

  LoopLink& link_;
  long long cycles_ = 0;
  long long missed_cycles_ = 0;
  ModeReport reported_;
  GainReport reported_gains_;
  ToolReport reported_tool_;
  std::uint32_t newest_order_ = 0;  ///< its number
  ToolSight tool_sight_;
};

}  // namespace tactus
