#pragma once

#include <cstdint>

#include "tactus/daemon/loop_link.h"
#include "tactus/supervisor/control_cycle.h"

namespace tactus::test {

/// Of a cycle.
struct LoopTimes {
  std::int64_t wake_latency_ns = 0, read_ns = 0, control_ns = 0, write_ns = 0;
};

/// The loop's side of a LoopLink, as HardwareLoop has it, for loops in virtual time.
class LoopSide {
 public:
  explicit LoopSide(LoopLink& link) : link_(link) {}

  long long cycles() const { return cycles_; }
  long long missedCycles() const { return missed_cycles_; }

  /// After a cycle's frames have been sent: hands on what it was, takes what was ordered meanwhile,
  /// and does ahead what the next one needs.
  void finish(ControlCycle& cycle, const CycleInput& input, const LoopTimes& times = {}) {
    ++cycles_;
    missed_cycles_ += input.missed_cycles;
    publish(cycle, input, times);
    takeOrders(cycle);
    cycle.prepare();
    report(cycle);
  }

 private:
  static constexpr int kMaxOrdersACycle = 8;
  static constexpr long long kCyclesToSeeTool = 16;

  void publish(const ControlCycle& cycle, const CycleInput& input, const LoopTimes& times) {
    if (LoopRecord* const record = link_.records.reserve()) {
      record->is_in_motion = cycle.isRecorded();
      if (record->is_in_motion) cycle.fill(record->cycle);
      record->cycle.wake_latency_ns = times.wake_latency_ns;
      record->cycle.read_ns = times.read_ns;
      record->cycle.step_ns = times.control_ns;
      record->cycle.write_ns = times.write_ns;
      link_.records.commit();
    }
    link_.pulse.late_in_a_row = input.late_in_a_row;
    link_.pulse.missed_cycles = missed_cycles_;
    link_.pulse.cycles = cycles_;
    const ModeReport& report = cycle.report();
    const bool is_new = report.mode != reported_.mode || report.fault != reported_.fault;
    if (!is_new && cycles_ > 1) return;
    reported_ = report;
    link_.reports.push(report);
  }

  void takeOrders(ControlCycle& cycle) {
    GainOrder gains;
    if (link_.gain_orders.take(gains)) cycle.order(gains);
    ToolOrder order;
    for (int i = 0; cycle.toolReport() && i < kMaxOrdersACycle; ++i) {
      if (!link_.tool_orders.pop(order)) return;
      cycle.order(order);
    }
  }

  void report(const ControlCycle& cycle) {
    const GainReport& gains = cycle.gainReport();
    if (gains != reported_gains_) link_.gain_reports.put(gains);
    reported_gains_ = gains;
    const ToolReport* const tool = cycle.toolReport();
    if (!tool || (*tool == reported_tool_ && cycles_ % kCyclesToSeeTool != 0)) return;
    reported_tool_ = *tool;
    cycle.fill(tool_sight_);
    link_.tool_sights.put(tool_sight_);
  }

  LoopLink& link_;
  long long cycles_ = 0, missed_cycles_ = 0;
  ModeReport reported_;
  GainReport reported_gains_;
  ToolReport reported_tool_;
  ToolSight tool_sight_;
};

}  // namespace tactus::test
