#include "tactus/daemon/loop_figures.h"

#include <nlohmann/json.hpp>

#include "tactus/record/time_figures.h"

namespace tactus {
namespace {

Json busJson(const LoopFigures::Bus& bus) {
  return {{"interface", bus.interface},          {"received", bus.counters.received},
          {"sent", bus.counters.sent},           {"refused", bus.counters.refused},
          {"held_back", bus.counters.held_back}, {"error_frames", bus.counters.error_frames},
          {"foreign", bus.counters.foreign}};
}

Json tactileJson(const TactileCounters& counters) {
  return {{"samples", counters.samples},
          {"incomplete", counters.incomplete},
          {"malformed", counters.malformed},
          {"repeated", counters.repeated}};
}

void add(const TactileCounters& counters, TactileCounters& sum) {
  sum.samples += counters.samples;
  sum.incomplete += counters.incomplete;
  sum.malformed += counters.malformed;
  sum.repeated += counters.repeated;
}

}  // namespace

Json loopJson(const LoopFigures& figures) {
  Json json = {{"cycles", figures.cycles},
               {"missed_cycles", figures.missed_cycles},
               {"dropped_records", figures.dropped_records},
               {"page_faults", figures.page_faults},
               {"cpu_ns_per_cycle", figures.cpu_ns_per_cycle},
               {"process_cpu_ns_per_cycle", figures.process_cpu_ns_per_cycle},
               {"wake_latency_ns", timesJson(timeFigures(figures.wake_latency))},
               {"read_ns", timesJson(timeFigures(figures.read))},
               {"control_ns", timesJson(timeFigures(figures.control))},
               {"write_ns", timesJson(timeFigures(figures.write))},
               {"buses", Json::array()},
               {"malformed_drive_frames", figures.malformed_drive_frames}};
  for (const LoopFigures::Bus& bus : figures.buses) json["buses"].push_back(busJson(bus));
  if (figures.tactile_modules.empty()) return json;
  // Not left to emplace_back(): without memory for the array nlohmann-json 3.11 crashes then.
  json["tactile_modules"] = Json::array();
  TactileCounters all;
  for (const LoopFigures::TactileModule& module : figures.tactile_modules) {
    add(module.counters, all);
    Json& entry = json["tactile_modules"].emplace_back(tactileJson(module.counters));
    entry["link"] = module.link;
  }
  json["tactile"] = tactileJson(all);
  return json;
}

}  // namespace tactus
