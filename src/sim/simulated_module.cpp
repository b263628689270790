#include "tactus/sim/simulated_module.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace tactus {
namespace {
constexpr double kMaxCounts = 8388607.0;  // signed 24 bits

/// C^T (C C^T)^-1, for a calibration of full rank: the loader accepts no other.
Eigen::Matrix<double, 8, 4> pseudoinverse(const Eigen::Matrix<double, 4, 8>& C) {
  const Eigen::Matrix4d gram = C * C.transpose();
  return C.transpose() * gram.inverse();
}
}  // namespace

SimulatedModule::SimulatedModule(const SimulatedModuleConfig& config)
    : config_(config),
      filters_{ButterworthLowPass(config.filter_cutoff_hz, config.filter_rate_hz),
               ButterworthLowPass(config.filter_cutoff_hz, config.filter_rate_hz),
               ButterworthLowPass(config.filter_cutoff_hz, config.filter_rate_hz),
               ButterworthLowPass(config.filter_cutoff_hz, config.filter_rate_hz)},
      channels_from_wrench_(pseudoinverse(config.channels.calibration)),
      random_(config.seed),
      steps_a_sample_(
          static_cast<int>(std::lround(config.channels.sample_period_s * config.filter_rate_hz))) {}

void SimulatedModule::update(const Wrench4& wrench) noexcept {
  Wrench4 filtered;
  for (int i = 0; i < 4; ++i)
    filtered[i] = config_.filtered ? filters_[i].update(wrench[i]) : wrench[i];
  if (steps_to_sample_-- > 0) return;
  steps_to_sample_ = steps_a_sample_ - 1;
  if (config_.lost_share > 0.0 && isLost()) return;
  const Wrench4 measured = measure(filtered);
  sample_ = {measured[0], measured[1], measured[2], measured[3], sample_.sequence + 1};
}

/// 53 random bits make up a number in [0, 1), the same on every machine.
bool SimulatedModule::isLost() noexcept {
  return static_cast<double>(random_() >> 11) * 0x1p-53 < config_.lost_share;
}

Wrench4 SimulatedModule::measure(const Wrench4& wrench) noexcept {
  if (!config_.quantised && config_.noise_N == 0.0) return wrench;
  Eigen::Matrix<double, 8, 1> channels = channels_from_wrench_ * wrench;
  for (int i = 0; i < 8; ++i) {
    double& force_N = channels[i];
    if (config_.noise_N > 0.0) force_N += config_.noise_N * normal_(random_);
    if (!config_.quantised) continue;
    const double counts =
        std::clamp(std::round(force_N * config_.channels.counts_per_N), -kMaxCounts, kMaxCounts);
    force_N = counts / config_.channels.counts_per_N;
    counts_[i] = static_cast<std::int32_t>(counts);
  }
  return config_.channels.calibration * channels;
}

}  // namespace tactus
