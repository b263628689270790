#include "tactus/daemon/loop_side.h"

namespace tactus {
namespace {

constexpr int kMaxOrdersACycle = 8;
constexpr long long kCyclesToSeeTool = 16;

}  // namespace

void LoopSide::finish(const Wake& wake, const LoopTimes& times, ControlCycle& cycle) noexcept {
  ++cycles_;
  missed_cycles_ += wake.skipped;
  publish(wake, times, cycle);
  takeOrders(cycle);
  cycle.prepare();
  reportGains(cycle);
  reportTool(cycle);
  if (cycle.isFinished()) link_.pulse.has_ended.store(true, std::memory_order_release);
}

void LoopSide::publish(const Wake& wake, const LoopTimes& times,
                       const ControlCycle& cycle) noexcept {
  if (LoopRecord* const record = link_.records.reserve()) {
    record->is_in_motion = cycle.isRecorded();
    if (record->is_in_motion) cycle.fill(record->cycle);
    record->cycle.wake_latency_ns = wake.latency_ns;
    record->cycle.read_ns = times.read_ns;
    record->cycle.step_ns = times.control_ns;
    record->cycle.write_ns = times.write_ns;
    link_.records.commit();
  }
  link_.pulse.late_in_a_row.store(wake.late_in_a_row, std::memory_order_relaxed);
  link_.pulse.missed_cycles.store(missed_cycles_, std::memory_order_relaxed);
  link_.pulse.way_on.store(cycle.wayOn(), std::memory_order_relaxed);
  link_.pulse.cycles.store(cycles_, std::memory_order_relaxed);
  const ModeReport& report = cycle.report();
  const bool is_new = report.mode != reported_.mode || report.fault != reported_.fault;
  if (!is_new && cycles_ > 1) return;
  if (link_.reports.push(report)) reported_ = report;  // else in the next cycle
}

void LoopSide::takeOrders(ControlCycle& cycle) noexcept {
  GainOrder gains;
  if (link_.gain_orders.take(gains)) cycle.order(gains);
  if (!cycle.toolReport()) return;
  ToolOrder hold;
  if (link_.tool_holds.take(hold)) takeOrder(hold, cycle);
  std::size_t seen = 0;
  for (int taken = 0; taken < kMaxOrdersACycle && seen < LoopLink::kToolOrders; ++seen) {
    const ToolOrder* const order = link_.tool_orders.front();
    if (!order) return;
    if (takeOrder(*order, cycle)) ++taken;
    link_.tool_orders.release();
  }
}

/// Not what comes after a newer one: an order that a hold has overtaken, or a hold that comes late.
bool LoopSide::takeOrder(const ToolOrder& order, ControlCycle& cycle) noexcept {
  if (static_cast<std::int32_t>(order.number - newest_order_) < 0) return false;
  newest_order_ = order.number;
  cycle.order(order);
  return true;
}

void LoopSide::reportGains(const ControlCycle& cycle) noexcept {
  const GainReport& report = cycle.gainReport();
  if (report == reported_gains_) return;
  reported_gains_ = report;
  link_.gain_reports.put(report);
}

void LoopSide::reportTool(const ControlCycle& cycle) noexcept {
  const ToolReport* const report = cycle.toolReport();
  if (!report || (*report == reported_tool_ && cycles_ % kCyclesToSeeTool != 0)) return;
  reported_tool_ = *report;
  cycle.fill(tool_sight_);
  link_.tool_sights.put(tool_sight_);
}

}  // namespace tactus
