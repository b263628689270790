#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "tactus/daemon/bus_port.h"
#include "tactus/daemon/loop_side.h"
#include "tactus/io/gpio_lines.h"
#include "tactus/rt/periodic_schedule.h"
#include "tactus/rt/system_call_filter.h"
#include "tactus/scene/scene.h"
#include "tactus/supervisor/control_cycle.h"
#include "tactus/supervisor/enable_wait.h"

namespace tactus {

/// The cycle on real buses and lines. Opens all of them, or throws one of the errors of CanSocket,
/// InterfaceLock and GpioLines and opens nothing.
class HardwareLoop {
 public:
  /// The run ends by itself after this many cycles of the task; 0: never. `filter` tells of system
  /// calls that the loop should not have made.
  HardwareLoop(const Scene& scene, long long max_task_cycles, const SystemCallFilter& filter,
               LoopLink& link);

  /// One cycle; false after the last one.
  bool cycle(const Wake& wake) noexcept;

  // Of a loop that has ended:
  std::size_t buses() const noexcept { return buses_.size(); }
  const BusCounters& counters(std::size_t bus) const noexcept {
    return buses_[bus]->socket.monitor().counters();
  }
  long long cycles() const noexcept { return side_.cycles(); }
  long long missedCycles() const noexcept { return side_.missedCycles(); }
  std::int64_t cpuTime_ns() const noexcept { return cpu_end_ns_ - cpu_start_ns_; }
  const ModeReport& report() const noexcept { return cycle_.report(); }
  const CanRobot& robot() const noexcept { return cycle_.robot(); }

 private:
  void readAll(const Wake& wake) noexcept;
  void writeAll() noexcept;

  const std::atomic<bool>& stop_requested_;
  const SystemCallFilter& filter_;
  long long max_task_cycles_;
  std::vector<std::unique_ptr<BusPort>> buses_;
  std::optional<GpioLines> lines_;
  EnableWait enable_wait_;
  ControlCycle cycle_;
  CycleInput input_;
  bool are_lines_written_ = true;
  LoopSide side_;
  std::int64_t cpu_start_ns_ = 0, cpu_end_ns_ = 0;
};

}  // namespace tactus
