#pragma once

#include <cstdint>

namespace tactus {

/// Turns velocities into counts/s as 60FF takes them. What rounding leaves over is carried into the
/// next cycle, so that the sum of what was sent never strays from the sum of what was asked by more
/// than half a count/s. Velocities beyond INTEGER32 saturate, and nothing of them is carried.
class VelocityCounts {
 public:
  explicit VelocityCounts(double signed_counts_per_unit) noexcept
      : counts_per_unit_(signed_counts_per_unit) {}

  /// velocity: not NaN, m/s or rad/s. Zero stays zero, whatever was carried.
  std::int32_t next(double velocity) noexcept;
  void reset() noexcept { carry_ = 0.0; }

 private:
  double counts_per_unit_;
  double carry_ = 0.0;  ///< counts/s, at most a half
};

}  // namespace tactus
