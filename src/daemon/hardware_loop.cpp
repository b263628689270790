#include "tactus/daemon/hardware_loop.h"

#include <time.h>

#include <algorithm>

#include "tactus/canopen/cycle_count.h"
#include "tactus/daemon/measured_start.h"
#include "tactus/rt/periodic_timer.h"

namespace tactus {
namespace {

std::int64_t threadTime_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

/// Of the enable line, before it lets an arm go on; no hand is quicker.
int offCycles(const Scene& scene) {
  constexpr double kLeastOff_s = 0.05;
  if (!scene.hardware->gpio || !scene.hardware->gpio->enable) return 0;
  const double debounce_s = scene.hardware->gpio->enable->debounce_s;
  return cyclesLasting(std::max(kLeastOff_s, debounce_s), scene.period_s);
}

}  // namespace

HardwareLoop::HardwareLoop(const Scene& scene, long long max_task_cycles,
                           const SystemCallFilter& filter, LoopLink& link)
    : stop_requested_(link.stop_requested),
      filter_(filter),
      max_task_cycles_(max_task_cycles),
      buses_(openBuses(*scene.hardware, scene.period_s)),
      enable_wait_(offCycles(scene)),
      cycle_(scene.controller, *scene.hardware, scene.period_s),
      side_(link) {
  const HardwareConfig& hardware = *scene.hardware;
  if (hardware.gpio) lines_.emplace(*hardware.gpio, scene.period_s);
}

bool HardwareLoop::cycle(const Wake& wake) noexcept {
  const std::int64_t woken_ns = now_ns();
  if (cycles() == 0) cpu_start_ns_ = threadTime_ns();
  readAll(wake);
  const std::int64_t read_ns = now_ns();
  cycle_.update(input_);
  const std::int64_t controlled_ns = now_ns();
  writeAll();
  const std::int64_t written_ns = now_ns();
  side_.finish(wake, {read_ns - woken_ns, controlled_ns - read_ns, written_ns - controlled_ns},
               cycle_);
  if (!cycle_.isFinished()) return true;
  cpu_end_ns_ = threadTime_ns();
  return false;
}

void HardwareLoop::readAll(const Wake& wake) noexcept {
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    input_.bus_faults[i] = buses_[i]->receive();
    cycle_.receive(static_cast<int>(i), buses_[i]->frames.frames());
  }
  if (lines_) input_.lines = enable_wait_.update(lines_->read());
  const bool is_done = max_task_cycles_ > 0 && cycle_.taskCycles() + 1 >= max_task_cycles_;
  input_.are_lines_lost = !input_.lines.is_valid || !are_lines_written_;
  input_.stop_requested =
      input_.stop_requested || is_done || stop_requested_.load(std::memory_order_relaxed);
  input_.missed_cycles = static_cast<int>(std::min<std::int64_t>(wake.skipped, 1'000'000));
  input_.late_in_a_row = static_cast<int>(std::min<std::int64_t>(wake.late_in_a_row, 1'000'000));
  input_.has_forbidden_call = filter_.forbiddenCalls().count > 0;
}

void HardwareLoop::writeAll() noexcept {
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    const int bus = static_cast<int>(i);
    if (!buses_[i]->send(cycle_.outbox(bus), cycle_.probe())) cycle_.noteHeldBack(bus);
  }
  if (lines_) are_lines_written_ = lines_->write(cycle_.lines());
}

}  // namespace tactus
