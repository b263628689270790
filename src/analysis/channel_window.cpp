#include "tactus/analysis/channel_window.h"

#include <cmath>

namespace tactus {
namespace {

constexpr double kLeastJudgedSigma = 2.0;  ///< counts
constexpr double kFlatShare = 0.2;         ///< of the samples at the outermost counts
constexpr double kQuietShare = 0.2;        ///< of the noise without load
constexpr double kOffZeroSigmas = 10.0;
constexpr int kLeastSamples = 20;

}  // namespace

void ChannelWindow::add(const ChannelVector& counts, double t_s) noexcept {
  if (samples_ == 0) {
    first_s_ = t_s;
    first_ = low_ = high_ = counts;
  }
  last_s_ = t_s;
  ++samples_;
  const double t = t_s - first_s_;
  const ChannelVector y = counts - first_;
  sum_t_ += t;
  sum_tt_ += t * t;
  sum_ += y;
  sum_ty_ += t * y;
  sum_squares_ += y.cwiseAbs2();
  for (int i = 0; i < 8; ++i) {
    if (counts[i] < low_[i]) at_low_[i] = 0.0;
    if (counts[i] > high_[i]) at_high_[i] = 0.0;
    low_[i] = std::min(low_[i], counts[i]);
    high_[i] = std::max(high_[i], counts[i]);
    at_low_[i] += counts[i] == low_[i] ? 1.0 : 0.0;
    at_high_[i] += counts[i] == high_[i] ? 1.0 : 0.0;
  }
}

ChannelFigures ChannelWindow::figures() const noexcept {
  ChannelFigures figures;
  figures.samples = samples_;
  if (samples_ == 0) return figures;
  const double n = samples_;
  figures.duration_s = last_s_ - first_s_;
  const ChannelVector mean = sum_ / n;
  figures.mean = first_ + mean;
  const double spread_t = sum_tt_ - sum_t_ * sum_t_ / n;
  if (spread_t > 0.0) figures.drift_per_s = (sum_ty_ - sum_t_ * mean) / spread_t;
  if (samples_ < 3) return figures;
  const ChannelVector squares =
      sum_squares_ - n * mean.cwiseAbs2() - spread_t * figures.drift_per_s.cwiseAbs2();
  figures.sigma = (squares.cwiseMax(0.0) / (n - 2.0)).cwiseSqrt();
  return figures;
}

bool ChannelWindow::isFlat(int i, const ChannelFigures& now,
                           const ChannelFigures& zero) const noexcept {
  const double sigma = zero.sigma[i];
  const double off = now.mean[i] - zero.mean[i];
  if (sigma < kLeastJudgedSigma || samples_ < kLeastSamples) return false;
  if (std::abs(off) < kOffZeroSigmas * sigma) return false;
  const double at_end = off > 0.0 ? at_high_[i] : at_low_[i];
  return at_end >= kFlatShare * samples_ || now.sigma[i] < kQuietShare * sigma;
}

std::optional<ChannelDefect> ChannelWindow::defect(const ChannelFigures* zero) const noexcept {
  const ChannelFigures now = figures();
  for (int i = 0; i < 8 && samples_ > 0; ++i) {
    if (high_[i] >= kChannelEnd) return ChannelDefect{i, ChannelTrouble::kAtItsEnd, high_[i]};
    if (low_[i] <= -kChannelEnd) return ChannelDefect{i, ChannelTrouble::kAtItsEnd, low_[i]};
    if (zero && isFlat(i, now, *zero))
      return ChannelDefect{i, ChannelTrouble::kFlatTopped,
                           now.mean[i] > zero->mean[i] ? high_[i] : low_[i]};
  }
  return std::nullopt;
}

}  // namespace tactus
