#include "tactus/sim/simulated_module.h"

#include <algorithm>
#include <cmath>

#include "tactus/sim/channel_shares.h"

namespace tactus {
namespace {
constexpr double kMaxCounts = 8388607.0;  // signed 24 bits

ButterworthLowPass filterOf(const SimulatedModuleConfig& config) {
  const bool is_in_module = config.filter_place == FilterPlace::kModule;
  return {config.filter_cutoff_hz,
          is_in_module ? config.filter_rate_hz : 1.0 / config.channels.sample_period_s};
}
}  // namespace

SimulatedModule::SimulatedModule(const SimulatedModuleConfig& config,
                                 const std::optional<Wrench5>& at_rest)
    : config_(config),
      filters_{filterOf(config), filterOf(config), filterOf(config), filterOf(config),
               filterOf(config)},
      channels_from_wrench_(channelShares(config.channels).leftCols<4>()),
      channels_from_moment_x_(channelShares(config.channels).col(4)),
      at_rest_(at_rest),
      sin_error_(std::sin(config.direction_error_rad)),
      cos_error_(std::cos(config.direction_error_rad)),
      random_(config.seed),
      steps_a_sample_(
          static_cast<int>(std::lround(config.channels.sample_period_s * config.filter_rate_hz))) {
  if (!at_rest_ || !config.tared) return;
  config_.noise_N = 0.0;  // a tare is the mean of many samples
  tare_ = measure(*at_rest_);
  config_.noise_N = config.noise_N;
}

void SimulatedModule::update(const Wrench5& wrench) noexcept {
  const Wrench5 felt =
      config_.filter_place == FilterPlace::kModule ? filterFromRest(wrench) : wrench;
  t_s_ += 1.0 / config_.filter_rate_hz;
  if (steps_to_delivery_ > 0 && --steps_to_delivery_ == 0) deliver();
  if (steps_to_sample_-- > 0) return;
  steps_to_sample_ = steps_a_sample_ - 1;
  if (config_.lost_share > 0.0 && chance() < config_.lost_share) return;
  if (steps_to_delivery_ > 0) deliver();
  Wrench5 measured = measure(felt);
  if (at_rest_) measured -= tare_;
  if (config_.filter_place == FilterPlace::kReader) measured = filter(measured);
  measured_ = {measured[0], measured[1], measured[2], measured[3], measured_.sequence + 1,
               measured[4]};
  steps_to_delivery_ = 0;
  if (config_.jitter_s > 0.0)
    steps_to_delivery_ =
        static_cast<int>(std::lround(chance() * config_.jitter_s * config_.filter_rate_hz));
  if (steps_to_delivery_ == 0) deliver();
}

Wrench5 SimulatedModule::filter(const Wrench5& wrench) noexcept {
  Wrench5 filtered;
  for (int i = 0; i < 5; ++i) filtered[i] = filters_[i].update(wrench[i]);
  return filtered;
}

/// What was felt from the beginning has long come through the filter.
Wrench5 SimulatedModule::filterFromRest(const Wrench5& wrench) noexcept {
  if (!at_rest_) return filter(wrench);
  return filter(wrench - *at_rest_) + *at_rest_;
}

void SimulatedModule::deliver() noexcept {
  sample_ = measured_;
  counts_ = measured_counts_;
}

/// 53 random bits make up a number in [0, 1), the same on every machine.
double SimulatedModule::chance() noexcept { return static_cast<double>(random_() >> 11) * 0x1p-53; }

/// As cells that are turned about x see it.
Wrench5 SimulatedModule::turned(const Wrench5& w) const noexcept {
  return Wrench5{{cos_error_ * w[0] + sin_error_ * w[1], cos_error_ * w[1] - sin_error_ * w[0],
                  cos_error_ * w[2] + sin_error_ * w[3], cos_error_ * w[3] - sin_error_ * w[2],
                  w[4]}};
}

void SimulatedModule::distort(Channels& forces_N) const noexcept {
  const std::vector<double>& gains = config_.channel_gains;
  const std::vector<double>& drifts = config_.channel_drifts_N_per_s;
  for (std::size_t i = 0; i < gains.size(); ++i) forces_N[static_cast<int>(i)] *= gains[i];
  for (std::size_t i = 0; i < drifts.size(); ++i) forces_N[static_cast<int>(i)] += drifts[i] * t_s_;
}

Wrench5 SimulatedModule::measure(const Wrench5& wrench) noexcept {
  const bool is_turned = config_.direction_error_rad != 0.0;
  const bool is_distorted =
      !config_.channel_gains.empty() || !config_.channel_drifts_N_per_s.empty();
  Wrench5 seen = is_turned ? turned(wrench) : wrench;
  if (!config_.channels.moment_x) seen[4] = 0.0;
  if (!config_.quantised && config_.noise_N == 0.0 && !is_distorted) return seen;
  const Eigen::Vector4d seen_by_all = seen.head<4>();
  Channels forces_N = channels_from_wrench_ * seen_by_all;
  if (config_.channels.moment_x) forces_N += seen[4] * channels_from_moment_x_;
  if (is_distorted) distort(forces_N);
  return read(forces_N);
}

Wrench5 SimulatedModule::read(Channels& forces_N) noexcept {
  for (int i = 0; i < 8; ++i) {
    double& force_N = forces_N[i];
    if (config_.noise_N > 0.0) force_N += config_.noise_N * normal_(random_);
    if (!config_.quantised) continue;
    const double counts =
        std::clamp(std::round(force_N * config_.channels.counts_per_N), -kMaxCounts, kMaxCounts);
    force_N = counts / config_.channels.counts_per_N;
    measured_counts_[i] = static_cast<std::int32_t>(counts);
  }
  const Eigen::Vector4d read = config_.channels.calibration * forces_N;
  const std::optional<TactileChannelRow>& moment_x = config_.channels.moment_x;
  return Wrench5{{read[0], read[1], read[2], read[3], moment_x ? moment_x->dot(forces_N) : 0.0}};
}

bool SimulatedModule::isSaturated() const noexcept {
  return std::ranges::any_of(counts_, [](std::int32_t c) { return std::abs(c) >= kMaxCounts; });
}

}  // namespace tactus
