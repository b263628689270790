#pragma once

#include <array>
#include <cstddef>

namespace tactus {

/// What a stroke has shown of a drive. Units: as believed, m or rad.
struct StrokeValues {
  double largest_error = 0.0;         ///< |commanded - measured|
  double lag_s = 0.0;                 ///< by which the drive follows; bus and cycle included
  double largest_acceleration = 0.0;  ///< of the measured motion
};

/// Collects them, a cycle at a time.
class StrokeFigures {
 public:
  explicit StrokeFigures(double period_s) noexcept : period_s_(period_s) {}

  /// commanded, speed: where the drive ought to be now, and how fast.
  void add(double commanded, double speed, double measured) noexcept;
  /// The largest acceleration is of second differences over some cycles, so that counts do not
  /// matter: nothing across a gap.
  void skip() noexcept { size_ = 0; }
  StrokeValues values() const noexcept;

 private:
  static constexpr std::size_t kHalf = 20;  ///< cycles of each difference

  double period_s_;
  StrokeValues values_;
  double error_speed_ = 0.0, speed_speed_ = 0.0;  ///< sums of products
  std::array<double, 2 * kHalf + 1> last_{};      ///< measured, a ring
  std::size_t next_ = 0, size_ = 0;
};

}  // namespace tactus
