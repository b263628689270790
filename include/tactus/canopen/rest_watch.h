#pragma once

namespace tactus {

/// Tells an axis that goes on moving from one that slows down, by its measured position alone: it
/// has moved in two windows in a row, and in the second one as far as in the first.
class RestWatch {
 public:
  static constexpr double kWindow_s = 0.05;
  static constexpr double kMoved = 1e-3;  ///< m or rad in a window; less is rest
  /// m or rad: a window must be shorter by so much, which is 0.08 m/s^2 or rad/s^2, to be one of an
  /// axis that slows down.
  static constexpr double kSlowing = 2e-4;

  explicit RestWatch(double period_s);

  void restart() noexcept { has_begun_ = has_way_before_ = false; }

  /// Once a cycle; position: m or rad, finite, as it was so many periods after that of the call
  /// before: feedback that comes a little late is of one period less, and the next of one more.
  /// True: it moves on.
  bool update(double position, int periods) noexcept;

 private:
  int window_cycles_;
  bool has_begun_ = false;
  bool has_way_before_ = false;  ///< a window has ended
  int cycles_ = 0;               ///< of the present window
  double begin_ = 0.0;
  double way_before_ = 0.0;
};

}  // namespace tactus
