#pragma once

#include <array>
#include <cmath>

namespace tactus {

/// Zero for what is too small to be anything in SI units, else x. What fades by a share of itself
/// never becomes zero, but after minutes subnormal, where rounding keeps it for ever, and every
/// operation on it costs processors a hundred times as much. By code and not by the processor's
/// mode, so that a recorded run replays to the bit on any machine.
inline double flushed(double x) noexcept { return std::abs(x) < 1e-100 ? 0.0 : x; }

/// 1 - exp(-dt / T): the share of the way to its input that a first-order lag covers in dt, exact
/// for an input held over the step. T = 0 covers all of it.
double lagShare(double dt_s, double time_constant_s) noexcept;

/// lagShare() that remembers its last result: the arguments hardly ever change, and an exponential
/// costs more than most of what a cycle does with it.
class KnownLagShare {
 public:
  double of(double dt_s, double time_constant_s) noexcept {
    if (dt_s != dt_s_ || time_constant_s != time_constant_s_) {
      dt_s_ = dt_s;
      time_constant_s_ = time_constant_s;
      share_ = lagShare(dt_s, time_constant_s);
    }
    return share_;
  }

 private:
  double dt_s_ = 0.0, time_constant_s_ = 0.0;
  double share_ = 1.0;
};

/// Of the rate: below it a filter of doubles, whose sum of coefficients is (2 pi cutoff / rate)^3,
/// no longer shows a constant as it is; here to 4e-6.
inline constexpr double kLeastCutoff = 1e-4;

/// 3rd-order Butterworth low pass by the bilinear transform with prewarping, direct form II
/// transposed: the filter of the tactile module (scipy.signal.butter(3, cutoff, fs=rate)). After a
/// force is gone it ends at zero.
class ButterworthLowPass {
 public:
  /// Throws std::invalid_argument unless 0 < cutoff_hz < rate_hz / 2.
  ButterworthLowPass(double cutoff_hz, double rate_hz);

  double update(double input) noexcept;

  /// Of z^0 to z^-3, for who studies a loop instead of running it; the denominator starts with 1.
  const std::array<double, 4>& numerator() const noexcept { return b_; }
  const std::array<double, 4>& denominator() const noexcept { return a_; }

 private:
  std::array<double, 4> b_;
  std::array<double, 4> a_;
  std::array<double, 3> state_{};
};

}  // namespace tactus
