#include "tactus/record/time_figures.h"

namespace tactus {

TimeFigures timeFigures(const Histogram& times) noexcept {
  return {times.min_ns(), times.percentile_ns(50), times.percentile_ns(99), times.max_ns()};
}

void writeTimes(const char* name, const TimeFigures& times, JsonWriter& json) {
  json.key(name).beginObject();
  json.key("min").value(times.min);
  json.key("median").value(times.median);
  json.key("p99").value(times.p99);
  json.key("max").value(times.max);
  json.endObject();
}

}  // namespace tactus
