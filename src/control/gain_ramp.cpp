#include "tactus/control/gain_ramp.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

namespace tactus {
namespace {

constexpr double kLeastDuration_s = 0.5;
constexpr double kTimeConstants = 5.0;
constexpr double kReturns = 8.0;
constexpr double kMostOfReturn_s = 10.0;  ///< a beta of nearly zero would take for ever

constexpr std::size_t kWords = sizeof(Gains) / sizeof(double);
using Words = std::array<double, kWords>;

constexpr std::size_t wordAt(std::size_t offset) noexcept { return offset / sizeof(double); }

constexpr std::size_t kForce = offsetof(Gains, force);
constexpr std::size_t kEstimator = kForce + offsetof(ForceGains, estimator);

constexpr std::array kInRatios = {
    wordAt(kForce + offsetof(ForceGains, time_constant_s)),
    wordAt(kForce + offsetof(ForceGains, min_approach_stiffness_N_per_m)),
    wordAt(kForce + offsetof(ForceGains, assumed_stiffness_N_per_m)),
    wordAt(kEstimator + offsetof(StiffnessEstimatorGains, filter_time_constant_s)),
    wordAt(kEstimator + offsetof(StiffnessEstimatorGains, min_N_per_m)),
    wordAt(kEstimator + offsetof(StiffnessEstimatorGains, max_N_per_m))};

bool goesInRatios(std::size_t word) noexcept {
  return std::find(kInRatios.begin(), kInRatios.end(), word) != kInRatios.end();
}

double between(double from, double to, double share, bool in_ratios) noexcept {
  if (from == to || !std::isfinite(from) || !std::isfinite(to)) return to;
  const double value = in_ratios && from > 0.0 && to > 0.0 ? from * std::pow(to / from, share)
                                                           : from + share * (to - from);
  return std::clamp(value, std::min(from, to), std::max(from, to));
}

}  // namespace

Gains gainsBetween(const Gains& from, const Gains& to, double share) noexcept {
  if (share <= 0.0) return from;
  if (share >= 1.0) return to;
  const auto a = std::bit_cast<Words>(from);
  const auto b = std::bit_cast<Words>(to);
  Words mixed;
  for (std::size_t i = 0; i < kWords; ++i) mixed[i] = between(a[i], b[i], share, goesInRatios(i));
  return std::bit_cast<Gains>(mixed);
}

double gainRampDuration_s(const Gains& from, const Gains& to) noexcept {
  const double T_s = std::max(from.force.time_constant_s, to.force.time_constant_s);
  const double least_s = std::max(kLeastDuration_s, kTimeConstants * T_s);
  if (!(to.force.activation_force_N > from.force.activation_force_N)) return least_s;
  const double beta_per_s = std::min(from.task.drift_gain_per_s, to.task.drift_gain_per_s);
  return std::max(least_s, std::min(kReturns / beta_per_s, kMostOfReturn_s));
}

}  // namespace tactus
