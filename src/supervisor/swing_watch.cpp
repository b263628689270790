#include "tactus/supervisor/swing_watch.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kTurns = 0.5;     ///< of least_N, back from an extreme
constexpr double kDiesAway = 0.8;  ///< from one swing to the next
constexpr double kForgets_s = 1.0;

}  // namespace

void SwingWatch::update(double force_N, double least_N, double period_s) noexcept {
  since_s_ += period_s;
  const double beyond = is_rising_ ? force_N - extreme_N_ : extreme_N_ - force_N;
  if (beyond > 0.0) extreme_N_ = force_N;
  if (beyond < -kTurns * least_N) {
    turn();
    extreme_N_ = force_N;
  }
  if (since_s_ > kForgets_s) swings_N_ = {};
  const auto& [newest_N, before_N, first_N] = swings_N_;
  const bool stays = newest_N >= kDiesAway * before_N && before_N >= kDiesAway * first_N;
  const double least = std::min({newest_N, before_N, first_N});
  swing_N_ = stays && least >= least_N ? least : 0.0;
}

void SwingWatch::turn() noexcept {
  swings_N_ = {std::abs(extreme_N_ - turned_N_), swings_N_[0], swings_N_[1]};
  turned_N_ = extreme_N_;
  is_rising_ = !is_rising_;
  since_s_ = 0.0;
}

}  // namespace tactus
