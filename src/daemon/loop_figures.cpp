#include "tactus/daemon/loop_figures.h"

#include "tactus/daemon/time_figures.h"

namespace tactus {
namespace {

void writeBus(const LoopFigures::Bus& bus, JsonWriter& json) {
  const auto count = [&json](const char* name, std::uint32_t value) {
    json.key(name).value(static_cast<long long>(value));
  };
  json.beginObject();
  json.key("interface").value(bus.interface);
  count("received", bus.counters.received);
  count("sent", bus.counters.sent);
  count("refused", bus.counters.refused);
  count("held_back", bus.counters.held_back);
  count("error_frames", bus.counters.error_frames);
  count("foreign", bus.counters.foreign);
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
  json.endObject();
}

}  // namespace tactus
