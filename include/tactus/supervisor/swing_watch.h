#pragma once

#include <array>

namespace tactus {

/// Finds a force that swings and does not settle: the turning points of the force, and how far
/// apart they are. What a touch leaves behind dies away; what is driven by the loop does not.
class SwingWatch {
 public:
  /// least_N: what swings by less from one turning point to the next is not looked at, > 0.
  void update(double force_N, double least_N, double period_s) noexcept;

  /// The least of the last three swings, of turning point to turning point, if they do not die
  /// away, N; else 0.
  double swing_N() const noexcept { return swing_N_; }

 private:
  static constexpr int kSwings = 3;  ///< a blow is two, to and fro

  void turn() noexcept;

  std::array<double, kSwings> swings_N_{};  ///< the newest first
  double turned_N_ = 0.0;                   ///< at the last turning point
  double extreme_N_ = 0.0;                  ///< since then
  double since_s_ = 0.0;
  bool is_rising_ = true;
  double swing_N_ = 0.0;
};

}  // namespace tactus
