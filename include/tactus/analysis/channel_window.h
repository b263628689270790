#pragma once

#include <cstdint>
#include <optional>

#include "tactus/math/types.h"

namespace tactus {

/// A number for each channel of a tactile module.
using ChannelVector = Eigen::Matrix<double, 8, 1>;

/// The largest counts of signed 24 bits.
inline constexpr double kChannelEnd = 8388607.0;

/// What the channels said over some time.
struct ChannelFigures {
  int samples = 0;
  double duration_s = 0.0;                            ///< from the first sample to the last
  ChannelVector mean = ChannelVector::Zero();         ///< counts
  ChannelVector sigma = ChannelVector::Zero();        ///< counts, about the line of the drift
  ChannelVector drift_per_s = ChannelVector::Zero();  ///< counts/s, slope of the best line
  /// Counts that all samples differ by multiples of: more than one of a converter of fewer bits
  /// whose counts are shifted up.
  double step = 1.0;
};

/// Why a channel says nothing of a force.
enum class ChannelTrouble {
  kAtItsEnd,    ///< a sample a step from +-2^23 or beyond, or all at a narrower converter's end
  kFlatTopped,  ///< stops short of that: below
};

struct ChannelDefect {
  int channel;  ///< from 0
  ChannelTrouble trouble;
  double counts;  ///< where it stops
};

/// The first channel of which figures alone show one of these, as those of a file: a mean within
/// three sigma of its end, without noise at the end of a converter of 11 to 22 bits and sign, or
/// without any while the others have some; with figures of the time without load also off its zero
/// by ten sigma and five times as quiet as there. A channel with less than two steps of noise
/// cannot be judged by that.
std::optional<ChannelDefect> figuresDefect(const ChannelFigures& now,
                                           const ChannelFigures* zero = nullptr) noexcept;

/// Counts of the eight channels over some time, and what they come to.
class ChannelWindow {
 public:
  void add(const ChannelVector& counts, double t_s) noexcept;

  int samples() const noexcept { return samples_; }
  ChannelFigures figures() const noexcept;

  /// The first channel that is at its end, or, with figures of the time without load, one whose
  /// cell or amplifier stops short of it: a fifth of its samples are its outermost counts; or what
  /// its figures show.
  std::optional<ChannelDefect> defect(const ChannelFigures* zero = nullptr) const noexcept;

 private:
  bool isCut(int channel, const ChannelFigures& now, const ChannelFigures& zero) const noexcept;

  int samples_ = 0;
  std::int64_t step_ = 0;  ///< counts, greatest common divisor of what samples differ by
  double first_s_ = 0.0, last_s_ = 0.0;
  double sum_t_ = 0.0, sum_tt_ = 0.0;
  ChannelVector first_ = ChannelVector::Zero();  ///< sums are of what differs from it
  ChannelVector sum_ = ChannelVector::Zero(), sum_squares_ = ChannelVector::Zero();
  ChannelVector sum_ty_ = ChannelVector::Zero();
  ChannelVector low_ = ChannelVector::Zero(), high_ = ChannelVector::Zero();
  ChannelVector at_low_ = ChannelVector::Zero(), at_high_ = ChannelVector::Zero();  ///< samples
};

}  // namespace tactus
