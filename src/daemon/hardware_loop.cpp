#include "tactus/daemon/hardware_loop.h"

#include <time.h>

#include <algorithm>

#include "tactus/io/bus_ids.h"
#include "tactus/rt/periodic_timer.h"

namespace tactus {
namespace {

constexpr int kMaxOrdersACycle = 8;
constexpr long long kCyclesToSeeTool = 16;

std::int64_t threadTime_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

CanSocket openSocket(const HardwareConfig& hardware, int bus) {
  const BusIds ids = busIds(hardware, bus);
  return CanSocket(hardware.buses[bus].interface, ids.received, ids.sent,
                   hardware.buses[bus].data_bit_rate_per_s.has_value());
}

}  // namespace

HardwareLoop::Bus::Bus(const HardwareConfig& hardware, int index)
    : lock(hardware.buses[index].interface), socket(openSocket(hardware, index)) {}

HardwareLoop::HardwareLoop(const Scene& scene, long long max_task_cycles,
                           const SystemCallFilter& filter, LoopLink& link)
    : link_(link),
      filter_(filter),
      max_task_cycles_(max_task_cycles),
      cycle_(scene.controller, *scene.hardware, scene.period_s) {
  const HardwareConfig& hardware = *scene.hardware;
  for (std::size_t i = 0; i < hardware.buses.size(); ++i)
    buses_.push_back(std::make_unique<Bus>(hardware, static_cast<int>(i)));
  if (hardware.gpio) lines_.emplace(*hardware.gpio, scene.period_s);
}

bool HardwareLoop::cycle(const Wake& wake) noexcept {
  const std::int64_t woken_ns = now_ns();
  if (cycles_ == 0) cpu_start_ns_ = threadTime_ns();
  readAll(wake);
  const std::int64_t read_ns = now_ns();
  cycle_.update(input_);
  const std::int64_t controlled_ns = now_ns();
  writeAll();
  const std::int64_t written_ns = now_ns();
  ++cycles_;
  missed_cycles_ += wake.skipped;
  publish(wake, read_ns - woken_ns, controlled_ns - read_ns, written_ns - controlled_ns);
  GainOrder order;
  if (link_.gain_orders.take(order)) cycle_.order(order);
  takeToolOrders();
  cycle_.prepare();
  reportGains();
  reportTool();
  if (!cycle_.isFinished()) return true;
  cpu_end_ns_ = threadTime_ns();
  return false;
}

void HardwareLoop::takeToolOrders() noexcept {
  if (!cycle_.toolReport()) return;
  for (int i = 0; i < kMaxOrdersACycle; ++i) {
    const ToolOrder* const order = link_.tool_orders.front();
    if (!order) return;
    cycle_.order(*order);
    link_.tool_orders.release();
  }
}

void HardwareLoop::reportTool() noexcept {
  const ToolReport* const report = cycle_.toolReport();
  if (!report || (*report == reported_tool_ && cycles_ % kCyclesToSeeTool != 0)) return;
  reported_tool_ = *report;
  cycle_.fill(tool_sight_);
  link_.tool_sights.put(tool_sight_);
}

void HardwareLoop::reportGains() noexcept {
  const GainReport& report = cycle_.gainReport();
  if (report == reported_gains_) return;
  reported_gains_ = report;
  link_.gain_reports.put(report);
}

void HardwareLoop::readAll(const Wake& wake) noexcept {
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    Bus& bus = *buses_[i];
    bus.socket.receive(bus.frames);
    bus.socket.monitor().update();
    input_.bus_faults[i] = bus.socket.monitor().fault();
    cycle_.receive(static_cast<int>(i), bus.frames.frames());
  }
  if (lines_) input_.lines = lines_->read();
  const bool is_done = max_task_cycles_ > 0 && cycle_.taskCycles() + 1 >= max_task_cycles_;
  input_.are_lines_lost = !input_.lines.is_valid || !are_lines_written_;
  input_.stop_requested =
      input_.stop_requested || is_done || link_.stop_requested.load(std::memory_order_relaxed);
  input_.missed_cycles = static_cast<int>(std::min<std::int64_t>(wake.skipped, 1'000'000));
  input_.late_in_a_row = static_cast<int>(std::min<std::int64_t>(wake.late_in_a_row, 1'000'000));
  input_.has_forbidden_call = filter_.forbiddenCalls().count > 0;
}

void HardwareLoop::writeAll() noexcept {
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    CanSocket& socket = buses_[i]->socket;
    const FrameBatch& outbox = cycle_.outbox(static_cast<int>(i));
    if (socket.monitor().mayProbe()) {
      socket.probe(cycle_.probe());
    } else if (!outbox.empty()) {
      socket.send(outbox.frames());
    }
  }
  if (lines_) are_lines_written_ = lines_->write(cycle_.lines());
}

void HardwareLoop::publish(const Wake& wake, std::int64_t read_ns, std::int64_t control_ns,
                           std::int64_t write_ns) noexcept {
  if (LoopRecord* const record = link_.records.reserve()) {
    record->is_in_motion = cycle_.isRecorded();
    if (record->is_in_motion) cycle_.fill(record->cycle);
    record->cycle.wake_latency_ns = wake.latency_ns;
    record->cycle.read_ns = read_ns;
    record->cycle.step_ns = control_ns;
    record->cycle.write_ns = write_ns;
    link_.records.commit();
  }
  link_.pulse.late_in_a_row.store(wake.late_in_a_row, std::memory_order_relaxed);
  link_.pulse.missed_cycles.store(missed_cycles_, std::memory_order_relaxed);
  link_.pulse.cycles.store(cycles_, std::memory_order_relaxed);
  const ModeReport& report = cycle_.report();
  const bool is_new = report.mode != reported_.mode || report.fault != reported_.fault;
  if (!is_new && cycles_ > 1) return;
  reported_ = report;
  link_.reports.push(report);
}

}  // namespace tactus
