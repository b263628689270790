#pragma once

#include <string>

#include "soak/latencies.h"
#include "support/virtual_robot_cell.h"
#include "tactus/daemon/control_socket.h"
#include "tactus/daemon/loop_side.h"
#include "tactus/daemon/telemetry.h"

namespace tactus::soak {

/// All of a daemon in virtual time but buses, lines and clock: what surrounds its cycle. Its end
/// without finish() is that of a daemon that was killed.
class Daemon {
 public:
  /// folder: of its log, which exists.
  Daemon(const Scene& scene, const std::string& folder, std::uint64_t seed)
      : scene_(scene),
        telemetry_(scene, folder, link_),
        socket_(scene, link_),
        side_(link_),
        latencies_(seed) {}

  /// After each cycle, in place of ControlCycle::prepare().
  /// Returns the times that it was given.
  Latencies::Times finishCycle(test::VirtualRobotCell& cell) {
    const Latencies::Times times = latencies_.draw();
    side_.finish({.latency_ns = times[0],
                  .skipped = cell.input.missed_cycles,
                  .late_in_a_row = cell.input.late_in_a_row},
                 {times[1], times[2], times[3]}, cell.cycle);
    if (side_.cycles() % kDrain_cycles == 0) telemetry_.drain();
    return times;
  }

  /// All cycles are in the log.
  void drain() { telemetry_.drain(); }

  /// As runDaemon() at its end.
  void finish(const test::VirtualRobotCell& cell) {
    drain();
    RunEnd end;
    end.fault = cell.cycle.report();
    end.loop.cycles = side_.cycles();
    end.loop.missed_cycles = side_.missedCycles();
    end.loop.dropped_records = droppedRecords();
    for (std::size_t i = 0; i < cell.monitors.size(); ++i)
      end.loop.buses.push_back({scene_.hardware->buses[i].interface, cell.monitors[i].counters()});
    telemetry_.finish(end);
  }

  long long cycles() const { return side_.cycles(); }
  long long missedCycles() const { return side_.missedCycles(); }
  long long droppedRecords() const { return static_cast<long long>(link_.records.dropped()); }
  const Latencies& latencies() const { return latencies_; }

 private:
  static constexpr int kDrain_cycles = 20;  ///< as often as runDaemon()

  const Scene& scene_;
  LoopLink link_;
  Telemetry telemetry_;
  ControlSocket socket_;
  LoopSide side_;
  Latencies latencies_;
};

}  // namespace tactus::soak
