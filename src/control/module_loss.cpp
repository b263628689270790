#include "tactus/control/module_loss.h"

#include <algorithm>

namespace tactus {
namespace {

bool tellsOfExcess(const TactileReading& reading) noexcept {
  return reading.fault == Fault::kTactileInvalid && reading.has_excess;
}

}  // namespace

bool isGood(const TactileReading& reading, const TactileModuleConfig& module) noexcept {
  return !reading.is_lost && reading.fault == Fault::kNone &&
         reading.age_s <= module.max_sample_age_s;
}

bool mayBeLost(const TactileReading& reading, double released_N) noexcept {
  if (tellsOfExcess(reading)) return false;
  const double of_late_N = std::max(reading.hardest.force_N, reading.contact.force_N);
  return reading.is_lost || of_late_N <= released_N;
}

void lose(TactileReading& reading) noexcept {
  reading.is_lost = true;
  reading.unproven_s = kModuleProof_s;
  reading.contact.force_N = reading.hardest.force_N = 0.0;
  reading.contact.interval_s = 0.0;
}

void prove(double period_s, TactileReading& reading) noexcept {
  reading.is_lost = false;
  reading.unproven_s = std::max(0.0, reading.unproven_s - period_s);
}

double nextSpeedShare(double lost_share, std::span<const TactileReading> readings, double period_s,
                      double speed_share) noexcept {
  const bool is_slow =
      std::ranges::any_of(readings, [](const TactileReading& r) { return r.unproven_s > 0.0; });
  const double step = period_s / kSpeedShareRise_s;
  return is_slow ? std::max(lost_share, speed_share - step) : std::min(1.0, speed_share + step);
}

}  // namespace tactus
