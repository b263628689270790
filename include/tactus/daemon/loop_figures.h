#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactus/canopen/tactile_receiver.h"
#include "tactus/io/bus_monitor.h"
#include "tactus/math/histogram.h"
#include "tactus/scene/json.h"

namespace tactus {

/// The figures that only a run in real time has.
struct LoopFigures {
  struct Bus {
    std::string interface;
    BusCounters counters;
  };

  Histogram wake_latency, read, control, write;
  long long cycles = 0;                   ///< of the loop, from the first to the last
  long long missed_cycles = 0;            ///< skipped because the loop woke too late
  long long dropped_records = 0;          ///< that the telemetry had no room for
  long long page_faults = 0;              ///< of the loop's thread from its first cycle on
  double cpu_ns_per_cycle = 0.0;          ///< of the loop's thread
  double process_cpu_ns_per_cycle = 0.0;  ///< of the whole daemon, log included
  std::vector<Bus> buses;
  long long malformed_drive_frames = 0;  ///< of wrong size
  struct TactileModule {
    std::string link;
    TactileCounters counters;
  };
  std::vector<TactileModule> tactile_modules;
};

/// The member "loop" of summary.json.
Json loopJson(const LoopFigures& figures);

}  // namespace tactus
