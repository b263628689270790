#include "tactus/control/tactile_reading.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// Beyond what any arm or obstacle bears, and far below where a square overflows.
constexpr double kMaxBelievable_N = 1e6;

/// |F|, N; not finite if any reading is.
double judgedForce_N(const TactileSample& sample) noexcept {
  const bool is_finite = std::isfinite(sample.moment_y_Nm) && std::isfinite(sample.moment_z_Nm) &&
                         std::isfinite(sample.moment_x_Nm);
  return is_finite ? std::hypot(sample.force_y_N, sample.force_z_N)
                   : std::numeric_limits<double>::quiet_NaN();
}

double fadedShare(double filter_cutoff_hz, double interval_s) noexcept {
  const double fades_s = std::max(kPushFades_s, kPushFadesPeriods / filter_cutoff_hz);
  return std::max(0.0, 1.0 - interval_s / fades_s);
}

void refuse(const FaultDetail& detail, TactileReading& reading) noexcept {
  reading.fault = Fault::kTactileInvalid;
  reading.detail = detail;
  reading.has_excess = false;
}

}  // namespace

Fault readSample(const TactileModuleConfig& module, const TactileSample& sample, double period_s,
                 TactileReading& reading) noexcept {
  reading.contact.interval_s = 0.0;
  if (sample.sequence == reading.sequence) {
    reading.age_s += period_s;
    if (reading.age_s <= module.max_sample_age_s) return reading.fault;
    reading.detail = {reading.age_s, module.max_sample_age_s, "s"};
    return Fault::kTactileStale;
  }
  reading.sequence = sample.sequence;
  const double interval_s = reading.age_s + period_s;
  reading.age_s = 0.0;
  reading.hardest.force_N =
      flushed(fadedShare(module.filter_cutoff_hz, interval_s) * reading.hardest.force_N);
  if (!isValid(sample, module)) {
    refuse({judgedForce_N(sample), module.max_force_N, "N"}, reading);
    reading.has_excess = reading.detail.value < kMaxBelievable_N;
    if (reading.has_excess) locateContact(sample, module, reading.excess);
  } else if (tellsItsPlace(sample, module) && offCover_m(sample, module) > module.length_m) {
    refuse({offCover_m(sample, module), module.length_m, "m"}, reading);
  } else {
    reading.fault = Fault::kNone;
    locateContact(sample, module, reading.contact);
    reading.contact.interval_s = interval_s;
    if (reading.contact.force_N >= reading.hardest.force_N) reading.hardest = reading.contact;
  }
  return reading.fault;
}

double sampleAge_s(const TactileSample& sample, double period_s,
                   const TactileReading& reading) noexcept {
  return sample.sequence == reading.sequence ? reading.age_s + period_s : 0.0;
}

}  // namespace tactus
