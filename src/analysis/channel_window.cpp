#include "tactus/analysis/channel_window.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tactus {
namespace {

constexpr double kLeastJudgedSigma = 2.0;  ///< steps
constexpr double kFlatShare = 0.2;         ///< of the samples at the outermost counts
constexpr double kQuietShare = 0.2;        ///< of the noise without load
constexpr double kOffZeroSigmas = 10.0;
constexpr double kEndSigmas = 3.0;
constexpr double kLeastMedianSigma = 10.0;  ///< steps: of channels that rustle
constexpr int kLeastSamples = 20;

/// So far that it is no noise, by a channel that has some.
bool isOff(int i, const ChannelFigures& now, const ChannelFigures& zero) noexcept {
  return zero.sigma[i] >= kLeastJudgedSigma * std::max(now.step, zero.step) &&
         std::abs(now.mean[i] - zero.mean[i]) >= kOffZeroSigmas * zero.sigma[i];
}

/// 2^n - 1 steps, or -2^n; some converters keep to +-(2^n - 1).
bool isEndOfConverter(double counts, double step) noexcept {
  counts /= step;
  for (int bits = 11; bits <= 22; ++bits) {
    const double end = std::ldexp(1.0, bits);
    if (std::abs(counts) == end - 1.0 || counts == -end) return true;
  }
  return false;
}

/// The largest multiple of a step that 24 bits hold.
double endOf(const ChannelFigures& now) noexcept { return kChannelEnd + 1.0 - now.step; }

double medianOf(ChannelVector values) noexcept {
  std::sort(values.begin(), values.end());
  return 0.5 * (values[3] + values[4]);
}

}  // namespace

std::optional<ChannelDefect> figuresDefect(const ChannelFigures& now,
                                           const ChannelFigures* zero) noexcept {
  const bool do_others_rustle = medianOf(now.sigma) >= kLeastMedianSigma * now.step;
  for (int i = 0; i < 8; ++i) {
    const double counts = now.mean[i], sigma = now.sigma[i];
    const bool is_at_end = std::abs(counts) + kEndSigmas * sigma >= endOf(now) ||
                           (sigma == 0.0 && isEndOfConverter(counts, now.step));
    if (is_at_end) return ChannelDefect{i, ChannelTrouble::kAtItsEnd, counts};
    const bool is_quiet = zero && isOff(i, now, *zero) && sigma < kQuietShare * zero->sigma[i];
    if (is_quiet || (sigma == 0.0 && do_others_rustle))
      return ChannelDefect{i, ChannelTrouble::kFlatTopped, counts};
  }
  return std::nullopt;
}

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
    step_ = std::gcd(step_, std::llround(y[i]));
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
  if (samples_ >= kLeastSamples && step_ > 0) figures.step = static_cast<double>(step_);
  const double spread_t = sum_tt_ - sum_t_ * sum_t_ / n;
  if (spread_t > 0.0) figures.drift_per_s = (sum_ty_ - sum_t_ * mean) / spread_t;
  if (samples_ < 3) return figures;
  const ChannelVector squares =
      sum_squares_ - n * mean.cwiseAbs2() - spread_t * figures.drift_per_s.cwiseAbs2();
  figures.sigma = (squares.cwiseMax(0.0) / (n - 2.0)).cwiseSqrt();
  return figures;
}

bool ChannelWindow::isCut(int i, const ChannelFigures& now,
                          const ChannelFigures& zero) const noexcept {
  if (!isOff(i, now, zero)) return false;
  const double at_end = now.mean[i] > zero.mean[i] ? at_high_[i] : at_low_[i];
  return at_end >= kFlatShare * samples_;
}

std::optional<ChannelDefect> ChannelWindow::defect(const ChannelFigures* zero) const noexcept {
  const ChannelFigures now = figures();
  for (int i = 0; i < 8 && samples_ > 0; ++i) {
    if (high_[i] >= endOf(now)) return ChannelDefect{i, ChannelTrouble::kAtItsEnd, high_[i]};
    if (low_[i] <= -endOf(now)) return ChannelDefect{i, ChannelTrouble::kAtItsEnd, low_[i]};
    if (zero && samples_ >= kLeastSamples && isCut(i, now, *zero))
      return ChannelDefect{i, ChannelTrouble::kFlatTopped,
                           now.mean[i] > zero->mean[i] ? high_[i] : low_[i]};
  }
  return samples_ >= kLeastSamples ? figuresDefect(now, zero) : std::nullopt;
}

}  // namespace tactus
