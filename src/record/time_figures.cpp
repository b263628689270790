#include "tactus/record/time_figures.h"

#include <nlohmann/json.hpp>

namespace tactus {

TimeFigures timeFigures(const Histogram& times) noexcept {
  return {times.min_ns(), times.percentile_ns(50), times.percentile_ns(99), times.max_ns()};
}

Json timesJson(const TimeFigures& times) {
  return {{"min", times.min}, {"median", times.median}, {"p99", times.p99}, {"max", times.max}};
}

}  // namespace tactus
