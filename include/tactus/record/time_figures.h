#pragma once

#include "tactus/math/histogram.h"
#include "tactus/scene/json.h"

namespace tactus {

/// Order statistics of durations, ns; median and p99 to 1/16.
struct TimeFigures {
  long long min = 0, median = 0, p99 = 0, max = 0;
};

TimeFigures timeFigures(const Histogram& times) noexcept;

/// An object with the four figures as its members.
Json timesJson(const TimeFigures& times);

}  // namespace tactus
