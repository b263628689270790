#include "tactus/daemon/loop_figures.h"

#include "tactus/record/time_figures.h"

namespace tactus {
namespace {

void writeCount(const char* name, std::uint32_t count, JsonWriter& json) {
  json.key(name).value(static_cast<long long>(count));
}

void writeBus(const LoopFigures::Bus& bus, JsonWriter& json) {
  json.beginObject();
  json.key("interface").value(bus.interface);
  writeCount("received", bus.counters.received, json);
  writeCount("sent", bus.counters.sent, json);
  writeCount("refused", bus.counters.refused, json);
  writeCount("held_back", bus.counters.held_back, json);
  writeCount("error_frames", bus.counters.error_frames, json);
  writeCount("foreign", bus.counters.foreign, json);
  json.endObject();
}

void writeTactile(const TactileCounters& counters, JsonWriter& json) {
  json.key("tactile").beginObject();
  writeCount("samples", counters.samples, json);
  writeCount("incomplete", counters.incomplete, json);
  writeCount("malformed", counters.malformed, json);
  writeCount("repeated", counters.repeated, json);
  json.endObject();
}

}  // namespace

void writeLoopFigures(const LoopFigures& figures, JsonWriter& json) {
  json.key("loop").beginObject();
  json.key("cycles").value(figures.cycles);
  json.key("missed_cycles").value(figures.missed_cycles);
  json.key("dropped_records").value(figures.dropped_records);
  json.key("page_faults").value(figures.page_faults);
  json.key("cpu_ns_per_cycle").value(figures.cpu_ns_per_cycle);
  json.key("process_cpu_ns_per_cycle").value(figures.process_cpu_ns_per_cycle);
  writeTimes("wake_latency_ns", timeFigures(figures.wake_latency), json);
  writeTimes("read_ns", timeFigures(figures.read), json);
  writeTimes("control_ns", timeFigures(figures.control), json);
  writeTimes("write_ns", timeFigures(figures.write), json);
  json.key("buses").beginArray();
  for (const LoopFigures::Bus& bus : figures.buses) writeBus(bus, json);
  json.endArray();
  json.key("malformed_drive_frames").value(figures.malformed_drive_frames);
  if (figures.tactile) writeTactile(*figures.tactile, json);
  json.endObject();
}

}  // namespace tactus
