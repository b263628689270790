#pragma once

#include <algorithm>
#include <cmath>

#include "tactus/analysis/contact_loop.h"

namespace tactus {

/// How often things happen in a loop, in steps of the plant: the shorter of cycle and filter
/// period.
struct ContactRates {
  double step_s;
  long cycle, filter, sample;
};

inline ContactRates contactRates(const ContactLoop& loop) {
  const double filter_period_s = 1.0 / loop.filter_rate_hz;
  const double step_s = std::min(loop.period_s, filter_period_s);
  const auto steps = [step_s](double period_s) { return std::lround(period_s / step_s); };
  return {step_s, steps(loop.period_s), steps(filter_period_s),
          steps(filter_period_s) * std::lround(loop.sample_period_s / filter_period_s)};
}

/// The cutoff of the approach limit's model of the filter, Hz: that is not prewarped, what stands
/// in for it here is.
double modelCutoff_hz(const ContactLoop& loop);

}  // namespace tactus
