#include "tactus/analysis/contact_peak.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/analysis/bisect.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

constexpr double kMostFilterSteps = 2e4;  ///< of the filter, so that a check stays quick
constexpr double kHighestCutoff = 0.4;    ///< of the filter's rate

double filterRate_hz(const ContactLoop& loop) {
  return loop.filters_at_samples ? 1.0 / loop.sample_period_s : loop.filter_rate_hz;
}

/// Where a spring reaches this force, m.
double penetrationAt(const ContactSpring& spring, double force_N) {
  double deep_m = 1e-6;
  while (spring.force_N(deep_m) <= force_N) deep_m *= 2.0;
  return bisect(0.0, deep_m, [&](double x_m) { return spring.force_N(x_m) <= force_N; });
}

/// The touch is halfway between two steps of the filter. A force that grows so slowly that nothing
/// is left of the filter's start comes through it late by its delay for slow signals, 2 / w_c.
double filterTime_s(const TouchedSpring& touched, double speed_m_per_s) {
  const double rate_hz = filterRate_hz(touched.loop);
  const double cutoff_hz = touched.loop.filter_cutoff_hz;
  ButterworthLowPass filter(cutoff_hz, rate_hz);
  const int steps = static_cast<int>(std::min(3.0 * rate_hz / cutoff_hz, kMostFilterSteps));
  for (int i = 0; i < steps; ++i) {
    const double t_s = (i + 0.5) / rate_hz;
    if (filter.update(touched.spring.force_N(speed_m_per_s * t_s)) > touched.threshold_N)
      return t_s;
  }
  return penetrationAt(touched.spring, touched.threshold_N) / speed_m_per_s +
         1.0 / (std::numbers::pi * cutoff_hz);
}

}  // namespace

double touchDelay_s(const TouchedSpring& touched, double speed_m_per_s) {
  const ContactLoop& loop = touched.loop;
  const double filter_period_s = 1.0 / filterRate_hz(loop);
  const auto wait_s = [&](double period_s) {
    return 0.5 * std::max(0.0, period_s - filter_period_s);
  };
  return filterTime_s(touched, speed_m_per_s) + wait_s(loop.sample_period_s) +
         wait_s(loop.period_s) + loop.drive_lag_s + loop.answer_lag_s;
}

double touchPeak_N(const TouchedSpring& touched, double speed_m_per_s) {
  return touched.spring.force_N(speed_m_per_s * touchDelay_s(touched, speed_m_per_s));
}

double touchSpeed_m_per_s(const TouchedSpring& touched, double force_N) {
  if (force_N <= touched.threshold_N) return 0.0;
  const auto stays = [&](double speed) { return touchPeak_N(touched, speed) <= force_N; };
  double fast = 1e-6;
  while (stays(fast) && fast < 1e6) fast *= 2.0;
  return bisect(0.0, fast, stays);
}

std::optional<double> touchCutoff_hz(TouchedSpring touched, double speed_m_per_s, double force_N) {
  const auto stays = [&](double cutoff_hz) {
    touched.loop.filter_cutoff_hz = cutoff_hz;
    return touchPeak_N(touched, speed_m_per_s) <= force_N;
  };
  const double lowest_hz = touched.loop.filter_cutoff_hz;
  const double highest_hz = kHighestCutoff * filterRate_hz(touched.loop);
  if (highest_hz <= lowest_hz || !stays(highest_hz)) return std::nullopt;
  return bisect(highest_hz, lowest_hz, stays);
}

double blowPeak_N(double speed_m_per_s, double stiffness_N_per_m, double mass_kg) {
  return speed_m_per_s * std::sqrt(stiffness_N_per_m * mass_kg);
}

double pushOf_N(const ObstacleConfig& obstacle, double standing_N) {
  return std::min(obstacle.slide_force_N.value_or(kNoLimit), standing_N);
}

}  // namespace tactus
